//! Settings for slicers that fill the outline with ribs themselves, as the published fingers were
//! sliced: parallel lines in one direction, their ends not connected, walls alone around them, no
//! top and no bottom.
//!
//! A slicer's density is not the design's: its pitch follows from its own line width. So the
//! settings give the pitch. Where the first rib lies is the slicer's choice.

use super::title;
use crate::geometry::Geometry;
use crate::printed::PrintedFinger;
use input::units::MM;
use std::f64::consts::PI;
use std::fmt::Write;

/// Height of a layer, mm: half the line width of the published fingers, a usual choice.
const LAYER: f64 = 0.2;
/// The settings of Cura 5.0; later versions read them.
const CURA_SETTING_VERSION: &str = "20";

/// A profile to import in Cura.
pub fn cura(geometry: &Geometry) -> String {
    let Walls { count, width } = Walls::of(&geometry.finger);
    let mut out = notes(geometry);
    section(
        &mut out,
        "general",
        &[("version", "4".into()), ("name", name(geometry)), ("definition", "fdmprinter".into())],
    );
    section(
        &mut out,
        "metadata",
        &[
            ("type", "quality_changes".into()),
            ("quality_type", "normal".into()),
            ("setting_version", CURA_SETTING_VERSION.into()),
        ],
    );
    section(
        &mut out,
        "values",
        &[
            ("layer_height", LAYER.to_string()),
            ("line_width", mm(geometry.finger.line_width)),
            ("wall_line_count", count.to_string()),
            ("wall_line_width_0", mm(width)),
            ("wall_line_width_x", mm(width)),
            ("top_layers", "0".into()),
            ("bottom_layers", "0".into()),
            ("infill_pattern", "lines".into()),
            ("infill_line_width", mm(geometry.finger.line_width)),
            ("infill_sparse_density", geometry.design.density_percent.to_string()),
            // Decides over the density.
            ("infill_line_distance", mm(geometry.pitch())),
            // 0 is along Y, positive turns the lines' upper end to +X: as of the design.
            ("infill_angles", format!("[{}]", geometry.design.direction_deg)),
            ("zig_zaggify_infill", "False".into()),
            ("infill_wall_line_count", "0".into()),
            ("infill_multiplier", "1".into()),
            ("gradual_infill_steps", "0".into()),
        ],
    );
    out
}

/// A configuration for PrusaSlicer, 2.4 or later: `prusa-slicer --load FILE`.
pub fn prusaslicer(geometry: &Geometry) -> String {
    let Walls { count, width } = Walls::of(&geometry.finger);
    let line = geometry.finger.line_width;
    let mut out = notes(geometry);
    values(
        &mut out,
        &[
            ("layer_height", LAYER.to_string()),
            ("extrusion_width", mm(line)),
            ("perimeters", count.to_string()),
            ("perimeter_generator", "classic".into()),
            ("extra_perimeters", "0".into()),
            ("external_perimeter_extrusion_width", mm(width)),
            ("perimeter_extrusion_width", mm(width)),
            ("top_solid_layers", "0".into()),
            ("bottom_solid_layers", "0".into()),
            ("ensure_vertical_shell_thickness", "0".into()),
            ("solid_infill_below_area", "0".into()),
            // The other rectilinear pattern turns by 90 degrees from layer to layer.
            ("fill_pattern", "alignedrectilinear".into()),
            ("infill_extrusion_width", mm(line)),
            ("fill_density", format!("{:.3}%", prusaslicer_density(geometry) * 100.0)),
            ("fill_angle", prusaslicer_angle(geometry.design.direction_deg).to_string()),
            ("infill_every_layers", "1".into()),
            ("infill_anchor", "0".into()),
            ("infill_anchor_max", "0".into()),
        ],
    );
    out
}

/// The density at which PrusaSlicer lays its lines at the design's pitch: the spacing of lines
/// that touch (their ends are half circles of the layer's height) over the pitch.
fn prusaslicer_density(geometry: &Geometry) -> f64 {
    let touching = geometry.finger.line_width / MM - LAYER * (1.0 - PI / 4.0);
    touching / (geometry.pitch() / MM)
}

/// PrusaSlicer counts from X, counter-clockwise; the design from Y, clockwise. 0 .. 180.
fn prusaslicer_angle(direction_deg: f64) -> f64 {
    (90.0 - direction_deg).rem_euclid(180.0)
}

/// The walls that make the skin.
struct Walls {
    count: u32,
    /// m.
    width: f64,
}

impl Walls {
    /// The fewest walls that are at most two lines wide.
    fn of(finger: &PrintedFinger) -> Walls {
        let count = (finger.skin / (2.0 * finger.line_width) - 1e-9).ceil().max(1.0);
        Walls { count: count as u32, width: finger.skin / count }
    }
}

fn name(geometry: &Geometry) -> String {
    title(geometry).replace(['%', '°', ','], "").replace("  ", " ")
}

fn notes(geometry: &Geometry) -> String {
    format!(
        "# {}: settings for its outline without ribs; the slicer lays them.\n\
         # The tip at low X, the front at high Y, as the outline's file has it: do not turn it.\n\
         # The solid base is a modifier with 100 % infill. The published fingers were printed with\n\
         # lines of 0.4 mm; here walls are as wide as the skin of the finger file.\n",
        title(geometry)
    )
}

fn section(out: &mut String, name: &str, entries: &[(&str, String)]) {
    // Writing to a string cannot fail.
    let _ = writeln!(out, "\n[{name}]");
    values(out, entries);
}

fn values(out: &mut String, entries: &[(&str, String)]) {
    for (key, value) in entries {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{key} = {value}");
    }
}

/// To a micrometre.
fn mm(length: f64) -> String {
    format!("{}", (length / MM * 1e3).round() / 1e3)
}
