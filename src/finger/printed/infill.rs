//! The infill of a printed finger.

use crate::input::printed::PrintedFinger;
use crate::units::{MM, PERCENT};

/// The infill of a finger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Design {
    /// Infill density, percent.
    pub density_percent: f64,
    /// Infill direction, degrees.
    pub direction_deg: f64,
    /// Where the first rib lies, mm; the finger file's if not given.
    pub phase_mm: Option<f64>,
}

/// Openings narrower than this, as the area over half the perimeter, close in printing, m.
pub(super) const NARROWEST_VOID: f64 = 0.05 * MM;

/// Distance between the centre lines of ribs, m.
pub(super) fn pitch(finger: &PrintedFinger, design: &Design) -> f64 {
    finger.ribs.line_spacing / (design.density_percent * PERCENT)
}
