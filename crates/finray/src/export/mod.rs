//! Files for printing a finger: a closed solid, its profile, a print sheet, and projects for slicers
//! that fill the outline with their own infill.
//!
//! Files are in millimetres: X from the tip to the base, Y from the back (0) to the front side, Z along
//! the depth, in which the layers of the print follow one another.

pub mod prism;
pub mod profile;
pub mod sheet;
pub mod slicer;

use crate::geometry::Geometry;
use crate::polygon::Ring;
use input::units::{MM, mm};
use nalgebra::Point2;

/// Returns the title of a file: `finray9, infill 20 %, 10°`.
pub fn title(geometry: &Geometry) -> String {
    let (name, design) = (&geometry.finger.name, &geometry.design);
    format!("{name}, infill {} %, {}°", design.density_percent, design.direction_deg)
}

/// Returns the outline (counter-clockwise), then openings and holes (clockwise), in the frame of the files, mm.
fn rings(geometry: &Geometry) -> Vec<Ring> {
    let width = geometry.finger.outline.width / MM;
    let moved = |ring: Vec<[f64; 2]>| ring.into_iter().map(|[x, y]| Point2::new(x, y + width));
    geometry.rings_mm().into_iter().map(|ring| moved(ring).collect()).collect()
}
