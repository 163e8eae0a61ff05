//! The solid profile of a printed finger: outline, skin and ribs, checked.

use super::FingerError;
use super::fit::Fit;
use super::infill::{Design, NARROWEST_VOID, RibLines, pitch};
use super::outline::ring;
use super::polygon::{self, HalfPlane, Ring, without_repeats};
use crate::printed::{Outline, PrintedFinger};
use input::units::MM;

/// A finger with its ribs: everything that its mechanics and its print need. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// The file it is made from, with what the design changed in it.
    pub finger: PrintedFinger,
    /// Its infill.
    pub design: Design,
    /// Counter-clockwise, whole finger, from the tip along the back.
    outer: Ring,
    /// Clockwise, one for each opening between ribs.
    voids: Vec<Ring>,
    /// Ribs with an opening on either side.
    ribs: usize,
}

/// Corners of an opening closer than this are one, m.
const NEAREST_CORNERS: f64 = 0.002 * MM;

impl Geometry {
    /// The finger with this infill.
    ///
    /// # Errors
    /// If its parts do not fit one another; the message names file and key.
    pub fn new(finger: &PrintedFinger, design: &Design) -> Result<Self, FingerError> {
        let check = Fit { finger, design };
        check.values()?;
        check.outline()?;
        check.ribs()?;
        let outer = without_repeats(&ring(&finger.outline, 0.0, finger.outline.length), 1e-9);
        let ribbed = finger.outline.length - finger.outline.solid;
        let inside = ring(&finger.outline, finger.skin, ribbed);
        check.rings(&outer, &inside)?;
        let gaps = gaps(&inside, finger, &RibLines::new(finger, design));
        let neighbours = gaps.windows(2).filter(|pair| pair[1].0 == pair[0].0 + 1);
        Ok(Geometry {
            finger: finger.clone(),
            design: *design,
            outer,
            ribs: neighbours.count(),
            voids: gaps.into_iter().flat_map(|(_, voids)| voids).collect(),
        })
    }

    /// The outer ring, counter-clockwise from the tip, and the openings, clockwise, m.
    /// X along the finger from the tip to the base, Y across it, 0 on the front.
    pub fn rings(&self) -> (&Ring, &[Ring]) {
        (&self.outer, &self.voids)
    }

    /// The same in millimetres, for files: the solid is what lies left of every ring.
    pub fn rings_mm(&self) -> Vec<Vec<[f64; 2]>> {
        let mm = |ring: &Ring| ring.iter().map(|p| [p.x / MM, p.y / MM]).collect();
        std::iter::once(&self.outer).chain(&self.voids).map(mm).collect()
    }

    /// How many ribs it has: those with an opening on either side.
    pub fn ribs(&self) -> usize {
        self.ribs
    }

    /// Distance between the centre lines of its ribs, m.
    pub fn pitch(&self) -> f64 {
        pitch(&self.finger, &self.design)
    }

    /// Distance of the first rib from the point that the finger file counts from, m.
    pub fn phase(&self) -> f64 {
        self.design.phase_mm.map_or(self.finger.ribs.phase, |mm| mm * MM)
    }

    /// Area of the solid profile, m2.
    pub fn area(&self) -> f64 {
        polygon::area(&self.outer) + self.voids.iter().map(|v| polygon::area(v)).sum::<f64>()
    }

    /// Mass of the printed finger, kg.
    pub fn mass(&self) -> f64 {
        self.area() * self.finger.outline.depth * self.finger.material.density
    }

    /// The outer ring of what the gripper leaves free: it ends where it is clamped.
    pub(super) fn free_ring(&self) -> Ring {
        let Outline { length, clamped, .. } = self.finger.outline;
        ring(&self.finger.outline, 0.0, length - clamped)
    }
}

/// The openings that ribs leave of the inside, clockwise, by the rib before them.
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
