//! The solid profile of a printed finger: outline, skin and ribs, checked.

use super::FingerError;
use super::fit::Fit;
use super::infill::{Design, NARROWEST_VOID, RibLines};
use super::outline::ring;
use super::polygon::{self, HalfPlane, Ring, without_repeats};
use crate::printed::PrintedFinger;
use input::units::MM;

/// Checked profile of a finger, SI units: X from the tip to the base, Y across, 0 on the front side.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Finger file, with the numbers that the design sets in it.
    pub finger: PrintedFinger,
    /// Infill.
    pub design: Design,
    /// Centre lines of the ribs.
    pub lines: RibLines,
    /// Outline, counter-clockwise from the tip along the back, m.
    pub outer: Ring,
    /// Openings between the ribs, clockwise, m.
    pub voids: Vec<Ring>,
    /// Number of ribs with an opening on either side.
    pub ribs: usize,
}

/// Distance below which two corners of an opening are one, m.
const NEAREST_CORNERS: f64 = 0.002 * MM;

impl Geometry {
    /// Profile of a finger with an infill.
    ///
    /// # Errors
    /// If its parts do not fit one another; the message names file and key.
    pub fn new(finger: &PrintedFinger, design: &Design) -> Result<Self, FingerError> {
        let lines = RibLines::new(finger, design);
        let check = Fit { finger, design };
        check.outline()?;
        check.ribs(lines.pitch)?;
        let outer = without_repeats(&ring(&finger.outline, 0.0, finger.outline.length), 1e-9);
        let ribbed = finger.outline.length - finger.outline.solid;
        let inside = ring(&finger.outline, finger.skin, ribbed);
        check.rings(&outer, &inside)?;
        let gaps = gaps(&inside, finger, &lines);
        let ribs = gaps.windows(2).filter(|pair| pair[1].0 == pair[0].0 + 1).count();
        let voids = gaps.into_iter().flat_map(|(_, voids)| voids).collect();
        Ok(Geometry { finger: finger.clone(), design: *design, lines, outer, voids, ribs })
    }

    /// Outline and openings, mm: the solid lies left of every ring.
    pub fn rings_mm(&self) -> Vec<Vec<[f64; 2]>> {
        let mm = |ring: &Ring| ring.iter().map(|p| [p.x / MM, p.y / MM]).collect();
        std::iter::once(&self.outer).chain(&self.voids).map(mm).collect()
    }

    /// Area of the solid profile, m2.
    pub fn area(&self) -> f64 {
        polygon::area(&self.outer) + self.voids.iter().map(|v| polygon::area(v)).sum::<f64>()
    }

    /// Mass of the printed finger, kg.
    pub fn mass(&self) -> f64 {
        self.area() * self.finger.outline.depth * self.finger.material.density
    }
}

/// Openings that the ribs leave of the inside, clockwise, by the number of the rib before them.
fn gaps(inside: &Ring, finger: &PrintedFinger, lines: &RibLines) -> Vec<(i64, Vec<Ring>)> {
    let half = finger.ribs.thickness / 2.0;
    let gap = |n: i64| {
        let after = HalfPlane { normal: lines.across, offset: lines.offset(n) + half };
        let before = HalfPlane { normal: -lines.across, offset: half - lines.offset(n + 1) };
        let pieces = after.cut(inside).into_iter().flat_map(|piece| before.cut(&piece));
        let mut voids: Vec<Ring> =
            pieces.map(|piece| without_repeats(&piece, NEAREST_CORNERS)).collect();
        voids.retain(|void| polygon::area(void) > NARROWEST_VOID * polygon::perimeter(void) / 2.0);
        voids.iter_mut().for_each(|void| void.reverse());
        (n, voids)
    };
    lines.range(inside).map(gap).filter(|(_, voids)| !voids.is_empty()).collect()
}
