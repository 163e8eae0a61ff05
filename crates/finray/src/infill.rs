//! The infill of a printed finger.

use crate::printed::PrintedFinger;
use input::units::{DEG, MM, PERCENT};
use nalgebra::{Point2, Vector2};

/// Infill of a finger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InfillDesign {
    /// Infill density, percent.
    pub density_percent: f64,
    /// Infill direction, degrees: 0 straight across the finger; positive tilts the ribs' front ends towards the base.
    pub direction_deg: f64,
    /// Phase of the first rib, mm; if not given, the phase in the finger file.
    pub phase_mm: Option<f64>,
}

/// Width of the narrowest opening that remains open in a print, as its area over half its perimeter, m.
pub(super) const MIN_VOID_WIDTH: f64 = 0.05 * MM;

/// Centre lines of the ribs: straight lines at `first + n pitch` along `across`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RibLines {
    /// Unit vector across the ribs.
    pub across: Vector2<f64>,
    /// Distance of the first centre line from the finger's origin, m.
    pub first: f64,
    /// Distance between centre lines, m.
    pub pitch: f64,
}

impl RibLines {
    /// Computes the centre lines from the finger file and the infill.
    pub fn new(finger: &PrintedFinger, design: &InfillDesign) -> Self {
        let (sin, cos) = libm::sincos(design.direction_deg * DEG);
        let across = Vector2::new(cos, -sin);
        let phase = design.phase_mm.map_or(finger.ribs.phase, |mm| mm * MM);
        let first = across.dot(&Vector2::from(finger.ribs.origin)) + phase;
        let pitch = finger.ribs.line_spacing / (design.density_percent * PERCENT);
        RibLines { across, first, pitch }
    }

    /// Returns the distance of a centre line from the origin, m.
    pub(super) fn offset(&self, n: i64) -> f64 {
        self.first + n as f64 * self.pitch
    }

    /// Returns the numbers of the lines that cross a ring, and of the next line on either side.
    pub(super) fn range(&self, ring: &[Point2<f64>]) -> std::ops::RangeInclusive<i64> {
        let places = ring.iter().map(|p| (self.across.dot(&p.coords) - self.first) / self.pitch);
        let span = |(low, high): (f64, f64), n: f64| (low.min(n), high.max(n));
        let (low, high) = places.fold((f64::MAX, f64::MIN), span);
        low.floor() as i64..=high.ceil() as i64
    }
}
