//! The mechanics against beams and solids; `verify::analytic::finger` has what is known exactly.

mod beams;
mod frame;
mod geometry;
mod solid;
mod stiffness;
mod touch;

use super::geometry::Geometry;
use super::infill::Design;
use crate::printed::PrintedFinger;

/// The shipped finger.
fn finray9() -> PrintedFinger {
    let text = include_str!("../../../../fingers/finray9.toml");
    PrintedFinger::parse(text, "fingers/finray9.toml").unwrap()
}

/// The shipped finger with an infill.
fn infill(density_percent: f64, direction_deg: f64) -> Geometry {
    let design = Design { density_percent, direction_deg, phase_mm: None };
    Geometry::new(&finray9(), &design).unwrap()
}
