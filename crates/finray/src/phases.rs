//! Where the first rib lies is the slicer's choice: a finger at all of its choices.

use super::FingerError;
use super::geometry::Geometry;
use super::infill::{Design, pitch};
use super::mechanics::{SIZE, planar};
use super::stiffness::PlanarStiffness;
use crate::printed::PrintedFinger;
use input::units::MM;
use rayon::prelude::*;

/// Phases looked at, evenly over one pitch from the finger file's.
pub const PHASES: usize = 8;

/// A finger's stiffness in its plane, with the part touching the pad; pad and roof.
pub type Planar = [PlanarStiffness; 2];

/// The stiffness at each of [`PHASES`] places of the first rib.
///
/// # Errors
/// If the finger cannot be made.
pub fn over_phases(
    finger: &PrintedFinger,
    density_percent: f64,
    direction_deg: f64,
) -> Result<Vec<Planar>, FingerError> {
    let design = Design { density_percent, direction_deg, phase_mm: None };
    // A density of 0 has no pitch: the first geometry says so.
    let at = |share: f64| {
        let phase = finger.ribs.phase + share * pitch(finger, &design);
        let phase_mm = (share > 0.0).then_some(phase / MM);
        planar(&Geometry::new(finger, &Design { phase_mm, ..design })?, SIZE)
    };
    // Collected by index, so that of several errors the same one is told.
    let found: Vec<_> = (0..PHASES).into_par_iter().map(|i| at(i as f64 / PHASES as f64)).collect();
    found.into_iter().collect()
}
