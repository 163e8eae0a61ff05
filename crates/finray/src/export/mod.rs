//! A printed finger for the printer: a closed solid, its profile, a sheet to print it by, and
//! settings for slicers that fill its outline themselves.
//!
//! Files are in millimetres: X from the tip to the base, Y from the back (0) to the front, Z the
//! depth, in which the profile is printed layer by layer.

mod dimension;
pub mod drawing;
pub mod dxf;
pub mod prism;
pub mod sheet;
pub mod slicer;
pub mod stl;
pub mod three_mf;

use crate::geometry::Geometry;
use input::units::MM;

/// `finray9, infill 20 %, 10°`: what a file is of.
pub fn title(geometry: &Geometry) -> String {
    let design = &geometry.design;
    format!(
        "{}, infill {} %, {}°",
        geometry.finger.name, design.density_percent, design.direction_deg
    )
}

/// The rings of the profile in the frame of the files, mm: first the outer one, counter-clockwise,
/// then the openings, clockwise.
fn rings(geometry: &Geometry) -> Vec<Vec<[f64; 2]>> {
    let width = geometry.finger.outline.width / MM;
    let mut rings = geometry.rings_mm();
    rings.iter_mut().flatten().for_each(|point| point[1] += width);
    rings
}
