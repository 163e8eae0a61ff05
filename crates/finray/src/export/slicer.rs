//! Settings for slicers that fill the outline with ribs themselves, as the published fingers were
//! sliced: parallel lines in one direction, their ends not connected, walls alone around them, no
//! top and no bottom.
//!
//! A slicer's density is not the design's: its pitch follows from its own line width. So the
//! settings give the pitch. Where the first rib lies is the slicer's choice.

use super::{mm, title};
use crate::geometry::Geometry;
use crate::printed::PrintedFinger;
use input::units::MM;
use std::f64::consts::PI;

/// Height of a layer, mm: half the line width of the published fingers, a usual choice.
const LAYER: f64 = 0.2;
/// Version of the settings of Cura 5.0; later versions read them.
const CURA_SETTING_VERSION: &str = "20";

/// Returns the profile to import in Cura, where `infill_line_distance` decides over the density. As in the
/// design, an angle of 0 is along Y, and a positive one turns the lines' upper end to +X.
pub fn cura(geometry: &Geometry) -> String {
    let (count, width) = walls(&geometry.finger);
    let name = title(geometry).replace(['%', '°', ','], "").replace("  ", " ");
    let notes = notes(geometry);
    let (wall, line) = (mm(width), mm(geometry.finger.line_width));
    let (density, distance) = (geometry.design.density_percent, mm(geometry.lines.pitch));
    let angle = geometry.design.direction_deg;
    format!(
        "{notes}
[general]
version = 4
name = {name}
definition = fdmprinter

[metadata]
type = quality_changes
quality_type = normal
setting_version = {CURA_SETTING_VERSION}

[values]
layer_height = {LAYER}
line_width = {line}
wall_line_count = {count}
wall_line_width_0 = {wall}
wall_line_width_x = {wall}
top_layers = 0
bottom_layers = 0
infill_pattern = lines
infill_line_width = {line}
infill_sparse_density = {density}
infill_line_distance = {distance}
infill_angles = [{angle}]
zig_zaggify_infill = False
infill_wall_line_count = 0
infill_multiplier = 1
gradual_infill_steps = 0
"
    )
}

/// Returns the configuration for PrusaSlicer, 2.4 or later: `prusa-slicer --load FILE`. The fill pattern is
/// `alignedrectilinear`: `rectilinear` turns by 90 degrees from layer to layer.
pub fn prusaslicer(geometry: &Geometry) -> String {
    let (count, width) = walls(&geometry.finger);
    let (wall, line) = (mm(width), mm(geometry.finger.line_width));
    let notes = notes(geometry);
    // At the design's pitch: the spacing of lines that touch (their ends are half circles of the
    // layer's height) over the pitch.
    let touching = geometry.finger.line_width / MM - LAYER * (1.0 - PI / 4.0);
    let density = touching / (geometry.lines.pitch / MM) * 100.0;
    // PrusaSlicer counts from X, counter-clockwise; the design from Y, clockwise.
    let angle = (90.0 - geometry.design.direction_deg).rem_euclid(180.0);
    format!(
        "{notes}layer_height = {LAYER}
extrusion_width = {line}
perimeters = {count}
perimeter_generator = classic
extra_perimeters = 0
external_perimeter_extrusion_width = {wall}
perimeter_extrusion_width = {wall}
top_solid_layers = 0
bottom_solid_layers = 0
ensure_vertical_shell_thickness = 0
solid_infill_below_area = 0
fill_pattern = alignedrectilinear
infill_extrusion_width = {line}
fill_density = {density:.3}%
fill_angle = {angle}
infill_every_layers = 1
infill_anchor = 0
infill_anchor_max = 0
"
    )
}

/// Returns the number and width, m, of the walls that make the skin: the fewest at most two lines wide.
fn walls(finger: &PrintedFinger) -> (u32, f64) {
    let count = (finger.skin / (2.0 * finger.line_width) - 1e-9).ceil().max(1.0);
    (count as u32, finger.skin / count)
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
