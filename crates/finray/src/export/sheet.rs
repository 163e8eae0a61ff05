//! Print sheet: one page on how to print a finger and how to check the print.

use super::{mm, profile, title};
use crate::geometry::Geometry;
use crate::holes::{Block, Direction};
use crate::mechanics::FingerStiffness;
use crate::outline::Outline;
use crate::printed::PrintedFinger;
use input::units::{DEG, GRAM, MM, N_PER_MM};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use nalgebra::{Point2, Vector2};

/// Width and height of the paper, A4 landscape, mm.
const PAPER: [f64; 2] = [297.0, 210.0];
/// Largest width and height of the drawing, mm on paper.
const ROOM: [f64; 2] = [215.0, 80.0];
/// Left and upper edge of the drawing, mm on paper.
const CORNER: [f64; 2] = [38.0, 58.0];

/// Stiffness of a finger at its pad, across and along it.
#[derive(Debug, Clone, Copy)]
pub struct AtPad<'a> {
    /// Computed from its ribs.
    pub ribs: &'a FingerStiffness,
    /// Mean and standard deviation by the model of measured fingers, N/m; `None` without any.
    pub measured: Option<[[f64; 2]; 2]>,
}

/// Print sheet as a page of HTML that prints on one sheet of paper.
pub fn html(geometry: &Geometry, stiffness: &AtPad) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                title { "Print sheet: " (title(geometry)) }
                style { (PreEscaped("@page{size:A4 landscape;margin:0}body{margin:0}svg{width:100%;max-height:100vh}")) }
            }
            body { (PreEscaped(svg(geometry, stiffness))) }
        }
    };
    page.into_string()
}

/// Print sheet as an SVG of an A4 page.
pub fn svg(geometry: &Geometry, stiffness: &AtPad) -> String {
    let [width, height] = PAPER;
    let [beyond, wing] = block(geometry);
    let size = geometry.finger.outline;
    let [long, wide] = [size.length / MM + beyond, size.width / MM + 2.0 * wing];
    let fits = (ROOM[0] / long).min(ROOM[1] / wide);
    let scale = if fits >= 1.0 { fits.floor() } else { 1.0 / (1.0 / fits).ceil() };
    let view = View { origin: Point2::new(CORNER[0], CORNER[1] + wing * scale), scale };
    let words = if scale >= 1.0 { format!("{scale} : 1") } else { format!("1 : {}", 1.0 / scale) };
    let svg = html! {
        svg xmlns="http://www.w3.org/2000/svg" width={ (width) "mm" } height={ (height) "mm" }
            viewBox={ "0 0 " (width) " " (height) } font-family="sans-serif" font-size="3.6" {
            rect width="100%" height="100%" fill="#fff" {}
            text x="15" y="17" font-size="7" { (title(geometry)) }
            text x="15" y="24" fill="#444" {
                (geometry.finger.description) ". Both fingers of a gripper are this part: print two."
            }
            text x="282" y="17" text-anchor="end" fill="#444" { "lengths in mm, drawn " (words) }
            (drawing(geometry, view))
            (lengths(geometry, view))
            (direction(geometry, view))
            (column(15.0, "Finger", &finger(geometry)))
            (column(104.0, "Print", &print(geometry)))
            (column(205.0, "Check the print", &check(geometry, stiffness)))
        }
    };
    svg.into_string() + "\n"
}

/// The finger as the sheet draws it, with its lengths (in a group of class `lengths`) and infill
/// directions, as an SVG of its own.
pub fn part(geometry: &Geometry) -> String {
    let ([beyond, wing], outline) = (block(geometry), &geometry.finger.outline);
    let scale = ROOM[0] / (outline.length / MM + beyond);
    let view = View { origin: Point2::new(22.0, 26.0 + wing * scale), scale };
    let size = [ROOM[0] + 44.0, (outline.width / MM + 2.0 * wing) * scale + 50.0];
    let svg = html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox={ "0 0 " (size[0]) " " (size[1].ceil()) }
            font-family="sans-serif" font-size="3.6" {
            (drawing(geometry, view))
            (lengths(geometry, view))
            (direction(geometry, view))
        }
    };
    svg.into_string()
}

/// Length of the block beyond a finger and its width beside it, on either side, mm.
fn block(geometry: &Geometry) -> [f64; 2] {
    let wing = |width: f64| ((width - geometry.finger.outline.width) / 2.0).max(0.0);
    geometry.block().map_or([0.0; 2], |(_, block)| [block.length / MM, wing(block.width) / MM])
}

/// What is written on the held part.
const HELD: &str = "held by the gripper";

/// Profile, the part of it that the gripper holds, and the block of its holes, these hidden.
fn drawing(geometry: &Geometry, view: View) -> Markup {
    let outline = &geometry.finger.outline;
    let place = |[x, y]: [f64; 2]| view.place(Point2::new(x, y)).into();
    let held = [outline.length - outline.clamped, outline.length];
    let words = view.place(Point2::new((held[0] + held[1]) / 2.0, -outline.width) / MM);
    html! {
        path d=(profile::path(geometry, place)) fill="#aab7c9" stroke="#223" stroke-width="0.15"
            fill-rule="evenodd" {}
        g fill="none" stroke="#223" stroke-width="0.3" {
            @if let Some((holes, block)) = geometry.block() {
                @let [[_, end], across, _] = holes.carrier(outline);
                (view.rectangle([outline.length - block.overlap, end], across, 0.0))
                g stroke-dasharray="2 1" {
                    @for [along, across, _] in holes.boxes(outline) {
                        @let round = if holes.axis == Direction::Depth { holes.diameter } else { 0.0 };
                        (view.rectangle(along, across, round / 2.0))
                    }
                }
            }
        }
        g fill="none" stroke="#a33" stroke-width="0.4" stroke-dasharray="2 1" {
            (view.rectangle(held, [-outline.width, 0.0], 0.0))
        }
        text x=(words.x) y=(words.y - 2.0) text-anchor="middle" fill="#a33"
            font-size=(fitting(outline.clamped / MM * view.scale, HELD)) { (HELD) }
    }
}

/// An angle in degrees, to a hundredth.
fn degrees(angle: f64) -> f64 {
    (angle / DEG * 100.0).round() / 100.0
}

/// Dimension lines of the outline.
fn lengths(geometry: &Geometry, view: View) -> Markup {
    let outline = &geometry.finger.outline;
    let [beyond, wing] = block(geometry).map(|length| length * view.scale);
    let at = |x: f64, y: f64| Point2::new(x, y) / MM;
    let Outline { length, width, tip, solid, clamped, .. } = *outline;
    let arc = outline.arc_end();
    let [pad, roof] = [outline.pad, outline.roof_length()].map(mm);
    let pad = format!("pad {pad} at {}°, roof {roof}", degrees(outline.pad_angle));
    let middle = view.place(at(arc / 2.0, -width));
    html! {
        g class="lengths" font-size="3.2" fill="#222" {
            (view.length(at(0.0, -width), at(length, -width), -16.0 - wing, &mm(length)))
            (view.length(at(arc, -width), at(length, -width), -8.0 - wing, &mm(length - arc)))
            (view.length(at(length, -width), at(length, 0.0), -8.0 - beyond, &mm(width)))
            (view.length(at(length - solid, 0.0), at(length, 0.0), 7.0 + wing, &format!("solid {}", mm(solid))))
            (view.length(at(length - clamped, 0.0), at(length, 0.0), 14.0 + wing, &format!("held {}", mm(clamped))))
            (view.length(at(0.0, -tip), at(0.0, 0.0), 12.0, &mm(tip)))
            (view.length(outline.tip_point() / MM, outline.corner() / MM, 5.0, &pad))
            text x=(middle.x - 12.0) y=(middle.y - 1.0) text-anchor="middle" {
                "R " (mm(outline.back_radius))
            }
        }
    }
}

/// Infill directions: 0 degrees, and the design's.
fn direction(geometry: &Geometry, view: View) -> Markup {
    let PrintedFinger { outline, .. } = &geometry.finger;
    let design = geometry.design.direction_deg;
    let middle = (outline.arc_end() + outline.length - outline.solid) / 2.0;
    let foot = Point2::new(middle, -outline.width);
    let reach = outline.width / MM + 14.0 / view.scale;
    let up = |angle: f64| Vector2::new(libm::sin(angle * DEG), libm::cos(angle * DEG));
    let end = |angle: f64| view.place(foot / MM + up(angle) * reach);
    let from = view.place(foot / MM);
    let label = |angle: f64| {
        let at = view.place(foot / MM + up(angle) * (reach + 2.0 / view.scale));
        html! { text x=(at.x) y=(at.y) text-anchor="middle" { (angle) "°" } }
    };
    html! {
        g stroke="#c60" stroke-width="0.4" fill="#c60" {
            g stroke-dasharray="2 1" { (line(from, end(0.0))) }
            (line(from, end(design)))
        }
        g fill="#a40" font-size="4" {
            @if design == 0.0 || design.abs() > 8.0 { (label(0.0)) }
            @if design != 0.0 { (label(design)) }
        }
    }
}

/// A heading, and names with their values below it.
fn column(x: f64, heading: &str, rows: &[(&str, String)]) -> Markup {
    html! {
        g transform={ "translate(" (x) ",152)" } font-size="3.4" {
            text font-size="4.4" font-weight="bold" { (heading) }
            @for (i, (name, value)) in rows.iter().enumerate() {
                text y=(7.0 + 5.2 * i as f64) fill="#555" { (name) }
                text x="27" y=(7.0 + 5.2 * i as f64) { (value) }
            }
        }
    }
}

fn finger(geometry: &Geometry) -> Vec<(&'static str, String)> {
    let PrintedFinger { material, outline, skin, ribs, .. } = &geometry.finger;
    let (design, lines) = (&geometry.design, &geometry.lines);
    let [x, y] = [ribs.origin.x, ribs.origin.y].map(mm);
    let mut rows = vec![
        ("material", format!("{}, {} GPa", material.name, material.modulus / 1e9)),
        ("infill", format!("{} %, {}°", design.density_percent, design.direction_deg)),
        ("ribs", format!("{} of {}, {} apart", geometry.ribs, mm(ribs.thickness), mm(lines.pitch))),
        ("first rib", format!("{} from ({x}, {y})", mm(lines.phase))),
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

fn print(geometry: &Geometry) -> Vec<(&'static str, String)> {
    vec![
        ("lies", "flat, as drawn; layers along the depth".to_owned()),
        ("0°", "ribs straight across the finger".to_owned()),
        ("above 0°", "front (upper) ends lean to the base".to_owned()),
        ("line width", mm(geometry.finger.line_width)),
        ("STL, 3MF", "ribs are in the file: thin walls on,".to_owned()),
        ("", "solid infill, no other".to_owned()),
        ("own infill", "parallel lines, ends not connected, one wall,".to_owned()),
        ("", "no top, no bottom; the base solid".to_owned()),
    ]
}

/// Standard deviation of the eleven shipped fingers from what their ribs say, as a share.
const SCATTER: f64 = 0.175;

fn check(geometry: &Geometry, AtPad { ribs, measured }: &AtPad) -> Vec<(&'static str, String)> {
    let ribs = [ribs.pad.in_compliance(), ribs.pad_and_roof.in_assembly()];
    let [across, along] = ribs.map(|value| format!("{:.2} N/mm, from the ribs", value / N_PER_MM));
    let of = |stiffness: [f64; 2]| {
        let [mean, sd] = stiffness.map(|value| value / N_PER_MM);
        // As many digits as pages and terminal show.
        let digits = if mean >= 10.0 { 1 } else { 2 };
        format!("{mean:.digits$} ± {sd:.digits$} N/mm, measured model")
    };
    let none = || "no measured model of it".to_owned();
    let [model_across, model_along] = measured.map_or([none(), none()], |found| found.map(of));
    let without = if geometry.block().is_some() { " without the block" } else { "" };
    let modulus = geometry.finger.material.modulus / 1e9;
    // What the trials were simulated with is what a print is to be.
    let (mean, sd, by) = match *measured {
        Some([[mean, sd], _]) => (mean, sd, "measured model"),
        None => (ribs[0], SCATTER * ribs[0], "from the ribs"),
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
        ("", format!("{least:.2} to {most:.2} N, {by} ± 2 sd")),
    ]
}

/// Overhang of an extension line over its dimension line, and half a tick, mm on paper.
const BEYOND: f64 = 1.5;
/// Gap between the drawn part and its extension line, mm on paper.
const GAP: f64 = 1.0;

/// Placement of a part on paper: millimetres, Y downwards.
#[derive(Debug, Clone, Copy)]
struct View {
    /// Position of the part's origin, mm on paper.
    origin: Point2<f64>,
    /// Size on paper by the size of the part.
    scale: f64,
}

impl View {
    /// Position on paper, mm, of a point of the part, mm with Y upwards.
    fn place(&self, point: Point2<f64>) -> Point2<f64> {
        self.origin + self.scale * Vector2::new(point.x, -point.y)
    }

    /// Rectangle between ends along X and Y, with corners of a radius, m of the part.
    fn rectangle(&self, [left, right]: [f64; 2], [low, high]: [f64; 2], radius: f64) -> Markup {
        let at = self.place(Point2::new(left, high) / MM);
        let [width, height, radius] =
            [right - left, high - low, radius].map(|value| value / MM * self.scale);
        html! { rect x=(at.x) y=(at.y) width=(width) height=(height) rx=(radius) {} }
    }

    /// Dimension line from `a` to `b` at a distance (mm on paper) to their left.
    fn length(&self, a: Point2<f64>, b: Point2<f64>, distance: f64, text: &str) -> Markup {
        let ends = [self.place(a), self.place(b)];
        let along = (ends[1] - ends[0]).normalize();
        let left = Vector2::new(along.y, -along.x) * distance.signum();
        let shown = ends.map(|end| end + left * distance.abs());
        let tick = (along + left) * BEYOND;
        html! {
            g stroke="#444" stroke-width="0.18" {
                @for (end, at) in ends.into_iter().zip(shown) {
                    (line(end + left * GAP, at + left * BEYOND))
                    (line(at - tick, at + tick))
                }
                (line(shown[0], shown[1]))
            }
            (beside(shown, text))
        }
    }
}

/// Straight line on paper.
fn line(a: Point2<f64>, b: Point2<f64>) -> Markup {
    let [x1, y1, x2, y2] = [a.x, a.y, b.x, b.y].map(|value| format!("{value:.2}"));
    html! { line x1=(x1) y1=(y1) x2=(x2) y2=(y2) {} }
}

/// Text that stands above the middle of a line on paper, never upside down.
fn beside([a, b]: [Point2<f64>; 2], text: &str) -> Markup {
    let (at, along) = (nalgebra::center(&a, &b), b - a);
    let along = if along.x < -1e-9 || (along.x < 1e-9 && along.y > 0.0) { -along } else { along };
    let degrees = libm::atan2(along.y, along.x).to_degrees();
    let turn = format!("translate({:.2},{:.2}) rotate({degrees:.2})", at.x, at.y);
    let size = fitting(along.norm(), text);
    html! { g transform=(turn) { text y="-1.2" text-anchor="middle" font-size=(size) { (text) } } }
}

/// Size of a text that fits a width, if one can be read, mm on paper.
fn fitting(width: f64, text: &str) -> String {
    format!("{:.2}", (width / (0.52 * text.chars().count() as f64)).clamp(2.0, 3.2))
}
