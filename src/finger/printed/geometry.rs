//! The solid profile of a printed finger: outline, skin and ribs, checked.

use super::FingerError;
use super::fit::Fit;
use super::infill::{Design, NARROWEST_VOID, pitch};
use super::outline::ring;
use super::polygon::{self, HalfPlane, Ring, without_repeats};
use crate::input::printed::{Outline, PrintedFinger};
use crate::units::{DEG, MM};
use nalgebra::Vector2;

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
        let voids = voids(&inside, finger, design);
        Ok(Geometry { finger: finger.clone(), design: *design, outer, voids })
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

/// The openings that ribs leave of the inside, clockwise.
fn voids(inside: &Ring, finger: &PrintedFinger, design: &Design) -> Vec<Ring> {
    let (sin, cos) = (design.direction_deg * DEG).sin_cos();
    let across = Vector2::new(cos, -sin);
    let pitch = pitch(finger, design);
    let phase = design.phase_mm.map_or(finger.ribs.phase, |mm| mm * MM);
    let first = across.dot(&finger.ribs.origin.coords) + phase;
    let places = inside.iter().map(|p| (across.dot(&p.coords) - first) / pitch);
    let (low, high) = places.fold((f64::MAX, f64::MIN), |(low, high), n| (low.min(n), high.max(n)));
    let half = finger.ribs.thickness / 2.0;
    let mut voids = Vec::new();
    for n in low.floor() as i64..=high.ceil() as i64 {
        let rib = first + n as f64 * pitch;
        let after = HalfPlane { normal: across, offset: rib + half };
        let before = HalfPlane { normal: -across, offset: -(rib + pitch - half) };
        for piece in after.cut(inside) {
            voids.extend(before.cut(&piece));
        }
    }
    voids.iter_mut().for_each(|void| *void = without_repeats(void, NEAREST_CORNERS));
    voids.retain(|void| polygon::area(void) > NARROWEST_VOID * polygon::perimeter(void) / 2.0);
    voids.iter_mut().for_each(|void| void.reverse());
    voids
}
