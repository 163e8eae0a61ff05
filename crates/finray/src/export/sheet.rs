//! Print sheet: one page on how to print a finger and how to check the print.

use super::profile::profile;
use super::slicer::settings;
use super::{mm, title};
use crate::geometry::Geometry;
use crate::holes::{Block, Direction};
use crate::mechanics::FingerStiffness;
use crate::outline::Outline;
use crate::printed::PrintedFinger;
use drawing::{Drawing, Font, Style, View};
use input::units::{DEG, GRAM, MM, N_PER_MM};
use maud::{DOCTYPE, PreEscaped, html};
use nalgebra::{Point2, Vector2};

/// Width and height of the paper, A4 landscape, mm.
const PAPER: [f64; 2] = [297.0, 210.0];
/// Largest width and height of the drawing, mm on paper.
const ROOM: [f64; 2] = [215.0, 80.0];
/// Left and upper edge of the drawing, mm on paper.
const CORNER: [f64; 2] = [38.0, 58.0];

/// Data of a sheet that the geometry does not contain: origin of the design, and stiffness at the pad, across it (y)
/// and along it (z).
#[derive(Debug, Clone, Copy)]
pub struct SheetData<'a> {
    /// Origin of the design, for example `for usb, study usb-gp-seed0`; empty if density and direction were given.
    pub origin: &'a str,
    /// Stiffness computed from the ribs.
    pub ribs: &'a FingerStiffness,
    /// Mean and standard deviation of the stiffness across, then along the pad, N/m, predicted from measured fingers,
    /// if there are any.
    pub measured: Option<[[f64; 2]; 2]>,
}

/// Returns the print sheet as a page of HTML that prints on one sheet of paper.
pub fn html(geometry: &Geometry, data: &SheetData) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                title { "Print sheet: " (title(geometry)) }
                style { (PreEscaped("@page{size:A4 landscape;margin:0}body{margin:0}svg{width:100%;max-height:100vh}")) }
            }
            body { (PreEscaped(svg(geometry, data))) }
        }
    };
    page.into_string()
}

/// Returns the print sheet as an SVG of an A4 page.
pub fn svg(geometry: &Geometry, data: &SheetData) -> String {
    let [beyond, wing] = block(geometry);
    let size = geometry.finger.outline;
    let [long, wide] = [size.length / MM + beyond, size.width / MM + 2.0 * wing];
    let fits = (ROOM[0] / long).min(ROOM[1] / wide);
    let scale = if fits >= 1.0 { fits.floor() } else { 1.0 / (1.0 / fits).ceil() };
    let view = View { origin: Point2::new(CORNER[0], CORNER[1] + wing * scale), scale };
    let drawn = if scale >= 1.0 { format!("{scale} : 1") } else { format!("1 : {}", 1.0 / scale) };
    let mut drawing = Drawing::default();
    drawing.white_background();
    drawing.text(Point2::new(15.0, 17.0), &title(geometry), Font::new(7.0));
    let about = &geometry.finger.description;
    let about = format!("{about}. Both fingers of a gripper are this part: print two.");
    drawing.text(Point2::new(15.0, 24.0), &about, Font::new(3.6));
    drawing.text(Point2::new(282.0, 24.0), data.origin, Font::new(3.6).end());
    let lengths = format!("lengths in mm, drawn {drawn}");
    drawing.text(Point2::new(282.0, 17.0), &lengths, Font::new(3.6).end());
    draw_finger(&mut drawing, geometry, view);
    write_column(&mut drawing, 15.0, "Finger", &finger_rows(geometry));
    write_column(&mut drawing, 89.0, "Print", &print_rows(geometry));
    write_column(&mut drawing, 191.0, "Check the print", &check_rows(geometry, data));
    drawing.svg(PAPER, "mm")
}

/// Returns the drawing of the finger on the sheet, with its dimensions (in a group of class `lengths`) and infill
/// directions, as a separate SVG.
pub fn part(geometry: &Geometry) -> String {
    let ([beyond, wing], outline) = (block(geometry), &geometry.finger.outline);
    let scale = ROOM[0] / (outline.length / MM + beyond);
    let view = View { origin: Point2::new(22.0, 26.0 + wing * scale), scale };
    let mut drawing = Drawing::default();
    draw_finger(&mut drawing, geometry, view);
    let height = (outline.width / MM + 2.0 * wing) * scale + 50.0;
    drawing.svg([ROOM[0] + 44.0, height.ceil()], "")
}

fn draw_finger(drawing: &mut Drawing, geometry: &Geometry, view: View) {
    draw_shape(drawing, geometry, view);
    drawing.group("lengths", |drawing| draw_dimensions(drawing, geometry, view));
    draw_directions(drawing, geometry, view);
}

/// Returns how far the block extends beyond the end of a finger, and beyond each of its sides, mm; 0 without a block.
fn block(geometry: &Geometry) -> [f64; 2] {
    let wing = |width: f64| ((width - geometry.finger.outline.width) / 2.0).max(0.0);
    geometry.block().map_or([0.0; 2], |(_, block)| [block.length / MM, wing(block.width) / MM])
}

/// Label of the clamped part of the base.
const HELD: &str = "held by the gripper";

/// Draws the profile, the clamped part of the base, and the block, with its holes as hidden edges.
fn draw_shape(drawing: &mut Drawing, geometry: &Geometry, view: View) {
    let outline = &geometry.finger.outline;
    let rectangle = |drawing: &mut Drawing, along: [f64; 2], across: [f64; 2], radius, style| {
        let ends = [0, 1].map(|end| view.place(Point2::new(along[end], across[end]) / MM));
        drawing.rectangle(ends, radius / MM * view.scale, style);
    };
    profile(drawing, geometry, view, Style::fill("#aab7c9").outlined("#223", 0.15));
    if let Some((holes, block)) = geometry.block() {
        let ([[_, end], across, _], line) = (holes.carrier(outline), Style::line("#223", 0.3));
        rectangle(drawing, [outline.length - block.overlap, end], across, 0.0, line);
        for [along, across, _] in holes.boxes(outline) {
            let round = if holes.axis == Direction::Depth { holes.diameter } else { 0.0 };
            rectangle(drawing, along, across, round / 2.0, line.dashed());
        }
    }
    let held = [outline.length - outline.clamped, outline.length];
    let style = Style::line("#a33", 0.4).dashed();
    rectangle(drawing, held, [-outline.width, 0.0], 0.0, style);
    let words = view.place(Point2::new((held[0] + held[1]) / 2.0, -outline.width) / MM);
    let font = Font::new(3.2).middle().colour("#a33");
    let font = font.fitting(HELD, outline.clamped / MM * view.scale, 2.0);
    drawing.text(words - Vector2::y() * 2.0, HELD, font);
}

/// Returns an angle in degrees, to a hundredth.
fn degrees(angle: f64) -> f64 {
    (angle / DEG * 100.0).round() / 100.0
}

/// Formats a length in mm to a tenth, the accuracy of a print.
fn tenth(length: f64) -> String {
    format!("{}", (length / MM * 10.0).round() / 10.0)
}

/// Draws the dimension lines of the outline.
fn draw_dimensions(drawing: &mut Drawing, geometry: &Geometry, view: View) {
    let outline = &geometry.finger.outline;
    let [beyond, wing] = block(geometry).map(|length| length * view.scale);
    let Outline { length, width, tip, solid, clamped, .. } = *outline;
    let arc = outline.arc_end();
    let [pad, roof] = [outline.pad, outline.roof_length()].map(tenth);
    let pad = format!("pad {pad} at {}°, roof {roof}", degrees(outline.pad_angle));
    let ends = [outline.tip_point(), outline.corner()].map(|p| [p.x, p.y]);
    for (ends, distance, words) in [
        ([[0.0, -width], [length, -width]], -16.0 - wing, tenth(length)),
        ([[arc, -width], [length, -width]], -8.0 - wing, tenth(length - arc)),
        ([[length, -width], [length, 0.0]], -8.0 - beyond, tenth(width)),
        ([[length - solid, 0.0], [length, 0.0]], 7.0 + wing, format!("solid {}", tenth(solid))),
        ([[length - clamped, 0.0], [length, 0.0]], 14.0 + wing, format!("held {}", tenth(clamped))),
        ([[0.0, -tip], [0.0, 0.0]], 12.0, tenth(tip)),
        (ends, 5.0, pad),
    ] {
        let ends = ends.map(|end| view.place(Point2::from(end) / MM));
        drawing.dimension(ends, distance, &words);
    }
    let middle = view.place(Point2::new(arc / 2.0, -width) / MM) - Vector2::new(12.0, 1.0);
    drawing.text(middle, &format!("R {}", tenth(outline.back_radius)), Font::new(3.2).middle());
}

/// Draws the infill directions: 0 degrees, and that of the design.
fn draw_directions(drawing: &mut Drawing, geometry: &Geometry, view: View) {
    let PrintedFinger { outline, .. } = &geometry.finger;
    let design = geometry.design.direction_deg;
    let middle = (outline.arc_end() + outline.length - outline.solid) / 2.0;
    let foot = view.place(Point2::new(middle, -outline.width) / MM);
    let reach = outline.width / MM * view.scale + 14.0;
    let up = |angle: f64| Vector2::new(libm::sin(angle * DEG), -libm::cos(angle * DEG));
    let style = Style::line("#c60", 0.4);
    drawing.line([foot, foot + up(0.0) * reach], style.dashed());
    drawing.line([foot, foot + up(design) * reach], style);
    // Below 8 degrees the label of 0 degrees would overlap that of the design.
    let named = [(0.0, design == 0.0 || design.abs() > 8.0), (design, design != 0.0)];
    for (angle, _) in named.into_iter().filter(|(_, named)| *named) {
        let font = Font::new(4.0).colour("#a40").middle();
        drawing.text(foot + up(angle) * (reach + 2.0), &format!("{angle}°"), font);
    }
}

/// Writes a heading, and below it names with their values.
fn write_column(drawing: &mut Drawing, x: f64, heading: &str, rows: &[(&str, String)]) {
    let (top, font) = (152.0, Font::new(3.4));
    drawing.text(Point2::new(x, top), heading, Font::new(4.4).bold());
    for (i, (name, value)) in rows.iter().enumerate() {
        let y = top + 7.0 + 5.2 * i as f64;
        drawing.text(Point2::new(x, y), name, font.colour("#555"));
        drawing.text(Point2::new(x + 25.0, y), value, font);
    }
}

fn finger_rows(geometry: &Geometry) -> Vec<(&'static str, String)> {
    let PrintedFinger { material, outline, skin, ribs, .. } = &geometry.finger;
    let (design, lines) = (&geometry.design, &geometry.lines);
    let mut rows = vec![
        ("material", format!("{}, {} GPa", material.name, material.modulus / 1e9)),
        ("infill", format!("{} %, {}°", design.density_percent, design.direction_deg)),
        ("ribs", format!("{} of {}, {} apart", geometry.ribs, mm(ribs.thickness), mm(lines.pitch))),
        ("skin", mm(*skin)),
        ("depth", mm(outline.depth)),
        ("mount", format!("{}° to the assembly", degrees(geometry.finger.tilt))),
    ];
    let Some(holes) = &geometry.finger.holes else { return rows };
    let [spacing, diameter] = [holes.spacing, holes.diameter].map(mm);
    let [row, beside] = holes.offset.map(mm);
    let words = [holes.axis, holes.row].map(Direction::word);
    rows.push(("holes", format!("{} × ⌀{diameter} along {}", holes.count, words[0])));
    rows.push(("", format!("{spacing} apart in {}, offset {row}, {beside}", words[1])));
    if let Some(Block { length, width, overlap }) = holes.block {
        let [length, width, overlap] = [length, width, overlap].map(mm);
        rows.push(("block", format!("{length} × {width}, {overlap} into the finger")));
    }
    rows
}

fn print_rows(geometry: &Geometry) -> Vec<(&'static str, String)> {
    let settings = settings(geometry);
    let set = |key| settings.iter().find(|(of, ..)| *of == key).map_or("", |(.., value)| value);
    let [line, layer] = ["extrusion_width", "layer_height"].map(set);
    let [walls, wall] = ["perimeters", "perimeter_extrusion_width"].map(set);
    let [density, angle] = ["fill_density", "fill_angle"].map(set);
    vec![
        ("lies", "flat, as drawn; layers along the depth".to_owned()),
        ("0°", "ribs straight across the finger".to_owned()),
        ("above 0°", "front (upper) ends lean to the base".to_owned()),
        ("line width", format!("{line}, layers {layer}, walls {walls} × {wall}")),
        ("STL, 3MF", "ribs are in the file: thin walls on,".to_owned()),
        ("", "solid infill, no other".to_owned()),
        ("own infill", format!("3MF with settings: {density}, {angle}° from X;")),
        ("", "do not turn it. Tried in PrusaSlicer, not".to_owned()),
        ("", "OrcaSlicer, Bambu Studio".to_owned()),
    ]
}

/// Standard deviation of the difference between measured and computed stiffness of the eleven published fingers,
/// relative to the computed stiffness.
const SCATTER: f64 = 0.175;

fn check_rows(geometry: &Geometry, data: &SheetData) -> Vec<(&'static str, String)> {
    let SheetData { ribs, measured, .. } = data;
    let ribs = [ribs.pad.in_compliance(), ribs.pad_and_roof.in_assembly()];
    let [across, along] = ribs.map(|value| format!("{:.2} N/mm, from the ribs", value / N_PER_MM));
    let of = |stiffness: [f64; 2]| {
        let [mean, sd] = stiffness.map(|value| value / N_PER_MM);
        // As many digits as in reports and on the terminal.
        let digits = if mean >= 10.0 { 1 } else { 2 };
        format!("{mean:.digits$} ± {sd:.digits$} N/mm, measured model")
    };
    let none = || "no measured model".to_owned();
    let [model_across, model_along] = measured.map_or([none(), none()], |model| model.map(of));
    let without = if geometry.block().is_some() { " without the block" } else { "" };
    let modulus = geometry.finger.material.modulus / 1e9;
    // The print is checked against the stiffness that the simulation uses.
    let (mean, sd, by) = match *measured {
        Some([[mean, sd], _]) => (mean, sd, "± 2 sd"),
        None => (ribs[0], SCATTER * ribs[0], "from the ribs ± 2 sd"),
    };
    let [least, most] = [-2.0, 2.0].map(|by| (mean + by * sd).max(0.0) * MM);
    vec![
        ("mass", format!("{:.2} g{without}", geometry.mass() / GRAM)),
        ("profile", format!("{:.1} mm2", geometry.area() / (MM * MM))),
        ("across pad", model_across),
        ("", format!("{across} at {modulus} GPa")),
        ("along pad", model_along),
        ("", format!("{along}, roof too")),
        ("check", "hold the base, push the pad's middle".to_owned()),
        ("", "1 mm across, free to turn: this takes".to_owned()),
        ("", format!("{least:.2} to {most:.2} N, {by}")),
    ]
}
