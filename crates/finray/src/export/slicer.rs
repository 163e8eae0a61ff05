//! Settings for slicers that fill the outline with ribs themselves, as the published fingers were sliced: parallel
//! lines in one direction, with unconnected ends, surrounded by walls, without top and bottom layers.
//!
//! A slicer derives the pitch of its lines from its density and its own line width, so its density differs from that of
//! the design: the settings reproduce the design's pitch. The slicer chooses the position of the first rib.

use super::prism::{self, DECLARATION, Prism, PrismError};
use super::{mm, title};
use crate::geometry::Geometry;
use crate::printed::PrintedFinger;
use input::units::MM;
use maud::{Markup, html};
use std::f64::consts::PI;

/// Height of a layer, mm: as usual, half the line width, 0.4 mm in the published fingers.
const LAYER: f64 = 0.2;
/// Returns the settings: the key in PrusaSlicer, the key in OrcaSlicer and Bambu Studio, and the value. A key is empty
/// if the program has no such setting. All three programs define angle and line spacing in the same way. The fill
/// pattern is `alignedrectilinear`, since `rectilinear` turns by 90 degrees from layer to layer.
pub fn settings(geometry: &Geometry) -> Vec<(&'static str, &'static str, String)> {
    let (count, width) = walls(&geometry.finger);
    let (wall, line) = (mm(width), mm(geometry.finger.line_width));
    // Density at the design's pitch: the spacing of lines that touch (the sides of their cross-section are
    // semicircles as high as a layer) divided by the pitch.
    let touching = geometry.finger.line_width / MM - LAYER * (1.0 - PI / 4.0);
    let density = touching / (geometry.lines.pitch / MM) * 100.0;
    // Slicers measure the angle from X, counter-clockwise; the design from Y, clockwise. Rounded, since 90 - 58.2 has
    // 15 decimals in binary.
    let angle = ((90.0 - geometry.design.direction_deg).rem_euclid(180.0) * 1e6).round() / 1e6;
    let [off, on] = ["0", "1"].map(|text| move || text.to_owned());
    vec![
        ("layer_height", "layer_height", LAYER.to_string()),
        ("extrusion_width", "line_width", line.clone()),
        ("perimeters", "wall_loops", count.to_string()),
        ("perimeter_generator", "wall_generator", "classic".to_owned()),
        ("extra_perimeters", "", off()),
        ("external_perimeter_extrusion_width", "outer_wall_line_width", wall.clone()),
        ("perimeter_extrusion_width", "inner_wall_line_width", wall),
        ("top_solid_layers", "top_shell_layers", off()),
        ("bottom_solid_layers", "bottom_shell_layers", off()),
        ("", "top_shell_thickness", off()),
        ("", "bottom_shell_thickness", off()),
        ("ensure_vertical_shell_thickness", "ensure_vertical_shell_thickness", off()),
        ("solid_infill_below_area", "minimum_sparse_infill_area", off()),
        ("fill_pattern", "sparse_infill_pattern", "alignedrectilinear".to_owned()),
        ("infill_extrusion_width", "sparse_infill_line_width", line.clone()),
        ("", "internal_solid_infill_line_width", line),
        ("fill_density", "sparse_infill_density", format!("{density:.3}%")),
        ("fill_angle", "infill_direction", angle.to_string()),
        ("infill_every_layers", "", on()),
        ("", "infill_combination", off()),
        ("", "fill_multiline", on()),
        ("", "align_infill_direction_to_model", on()),
        ("infill_anchor", "infill_anchor", off()),
        ("infill_anchor_max", "infill_anchor_max", off()),
    ]
}

/// Returns a 3MF file with outline and solid base and PrusaSlicer's settings for this object, which are read when
/// it is opened as a project. The angle is that of the bed: the object must not be turned.
///
/// # Errors
/// If a surface is not closed, or the zip cannot be written.
pub fn prusaslicer_project(geometry: &Geometry) -> Result<Vec<u8>, PrismError> {
    let (outline, base) = (Prism::outline(geometry)?, Prism::base(geometry)?);
    let ends = [outline.triangles.len(), outline.triangles.len() + base.triangles.len()];
    let config = html! {
        config {
            object id="1" instances_count="1" {
                @for (key, _, value) in settings(geometry) {
                    @if !key.is_empty() { metadata type="object" key=(key) value=(value) {} }
                }
                volume firstid="0" lastid=(ends[0] - 1) {
                    metadata type="volume" key="name" value="outline" {}
                    metadata type="volume" key="volume_type" value="ModelPart" {}
                }
                volume firstid=(ends[0]) lastid=(ends[1] - 1) {
                    metadata type="volume" key="name" value="solid base" {}
                    metadata type="volume" key="modifier" value="1" {}
                    metadata type="volume" key="volume_type" value="ParameterModifier" {}
                    metadata type="volume" key="fill_density" value="100%" {}
                    metadata type="volume" key="fill_pattern" value="rectilinear" {}
                }
            }
        }
    };
    project(&[&outline.merged(&base)], geometry, "Metadata/Slic3r_PE_model.config", &config)
}

/// Returns a 3MF file with outline and solid base and their settings for OrcaSlicer and Bambu Studio, which are read
/// when it is opened as a project. Both programs require volumes to be components of an object, which PrusaSlicer would
/// split into separate objects. Structure and keys follow the sources of OrcaSlicer 2.3 and Bambu Studio 2.6
/// (`libslic3r/Format/bbs_3mf.cpp`, `PrintConfig.cpp`).
///
/// # Errors
/// See [`prusaslicer_project`].
pub fn orcaslicer_project(geometry: &Geometry) -> Result<Vec<u8>, PrismError> {
    let parts = [&Prism::outline(geometry)?, &Prism::base(geometry)?];
    let config = html! {
        config {
            object id=(prism::object_id(parts.len())) {
                metadata key="name" value=(title(geometry)) {}
                @for (_, key, value) in settings(geometry) {
                    @if !key.is_empty() { metadata key=(key) value=(value) {} }
                }
                part id="1" subtype="normal_part" { metadata key="name" value="outline" {} }
                part id="2" subtype="modifier_part" {
                    metadata key="name" value="solid base" {}
                    metadata key="sparse_infill_density" value="100%" {}
                    // OrcaSlicer reads this value as `rectilinear`, a name that Bambu Studio does not know.
                    metadata key="sparse_infill_pattern" value="zig-zag" {}
                }
            }
        }
    };
    project(&parts, geometry, "Metadata/model_settings.config", &config)
}

/// Returns a 3MF file that contains a configuration under a name.
fn project(
    parts: &[&Prism],
    geometry: &Geometry,
    name: &str,
    config: &Markup,
) -> Result<Vec<u8>, PrismError> {
    let config = DECLARATION.to_owned() + &config.0.replace("></metadata>", "/>");
    let zip = prism::three_mf(parts, &title(geometry), &[(name, &config)]);
    zip.map_err(|error| PrismError(error.to_string()))
}

/// Returns the number and the width, m, of the walls that form the skin: as few walls as possible, each at most two
/// line widths wide.
fn walls(finger: &PrintedFinger) -> (u32, f64) {
    let count = (finger.skin / (2.0 * finger.line_width) - 1e-9).ceil().max(1.0);
    (count as u32, finger.skin / count)
}
