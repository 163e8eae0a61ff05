//! Outline of a printed finger.

use crate::polygon::Ring;
use input::units::{DEG, MM};
use nalgebra::{Point2, Vector2};

/// Largest distance of the arc of the back from its chords, m.
const SAGITTA: f64 = 0.001 * MM;

/// Outline of a finger, m; X is 0 at the tip and increases towards the base, Y is 0 on the front side and negative
/// inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outline {
    /// Length from tip to end.
    pub length: f64,
    /// Width from front side to back.
    pub width: f64,
    /// Depth of the extruded profile.
    pub depth: f64,
    /// Distance of the tip behind the front side.
    pub tip: f64,
    /// Radius of the arc between back and tip.
    pub back_radius: f64,
    /// Length of the pad, from the tip to the notch's corner.
    pub pad: f64,
    /// Angle between pad and axis, rad.
    pub pad_angle: f64,
    /// Length of the section of the roof, from the corner, that rests on the gripped part.
    pub roof: f64,
    /// Length of the base, which is solid.
    pub solid: f64,
    /// Length of the part of the base that the gripper clamps.
    pub clamped: f64,
}

impl Outline {
    /// Returns the tip of the finger, m.
    pub fn tip_point(&self) -> Point2<f64> {
        Point2::new(0.0, -self.tip)
    }

    /// Returns the unit vector along the pad, from the tip to the notch's corner: the assembly direction z.
    pub fn along_pad(&self) -> Vector2<f64> {
        Vector2::new(libm::cos(self.pad_angle), libm::sin(self.pad_angle))
    }

    /// Returns the unit vector out of the pad's face towards the part: the compliance direction y.
    pub fn out_of_pad(&self) -> Vector2<f64> {
        let z = self.along_pad();
        Vector2::new(-z.y, z.x)
    }

    /// Returns the corner between pad and roof, m.
    pub fn corner(&self) -> Point2<f64> {
        self.tip_point() + self.along_pad() * self.pad
    }

    /// Returns the middle of the pad, where stiffness is stated, m.
    pub fn pad_middle(&self) -> Point2<f64> {
        self.tip_point() + self.along_pad() * (self.pad / 2.0)
    }

    /// Returns the length of the whole roof, from the corner to the front side, m.
    pub fn roof_length(&self) -> f64 {
        -self.corner().y / self.out_of_pad().y
    }

    /// Returns the X coordinate at which the arc of the back ends and the straight back begins, m.
    pub fn arc_end(&self) -> f64 {
        self.arc_centre().unwrap_or_default().x
    }

    /// Returns the centre of the arc, m, which passes through the tip and is tangent to the back; `None` if the radius
    /// is too small.
    pub(super) fn arc_centre(&self) -> Option<Point2<f64>> {
        let rise = self.width - self.tip;
        let square = rise * (2.0 * self.back_radius - rise);
        (square > 0.0 && rise < self.back_radius)
            .then(|| Point2::new(square.sqrt(), self.back_radius - self.width))
    }
}

/// Returns the outline moved inwards by `inset` and cut off at X = `end`, m, counter-clockwise from the tip.
/// Lines and arc are offset separately and meet in mitred corners.
pub(super) fn ring(outline: &Outline, inset: f64, end: f64) -> Ring {
    let (z, y) = (outline.along_pad(), outline.out_of_pad());
    let centre = outline.arc_centre().unwrap_or_default();
    let radius = outline.back_radius - inset;
    let pad = outline.tip_point() - y * inset;
    // Where the pad's line meets the arc, on the tip's side.
    let to_pad = pad - centre;
    let half = z.dot(&to_pad);
    let tip = pad - z * (half + (half * half - to_pad.norm_squared() + radius * radius).sqrt());
    let start = libm::atan2((tip - centre).y, (tip - centre).x).rem_euclid(360.0 * DEG);
    let sweep = 270.0 * DEG - start;
    let chords = (sweep / (8.0 * SAGITTA / radius).sqrt()).ceil().max(1.0);
    let mut ring: Ring = (0..=chords as usize)
        .map(|i| {
            let angle = start + sweep * i as f64 / chords;
            centre + radius * Vector2::new(libm::cos(angle), libm::sin(angle))
        })
        .collect();
    let corner = outline.corner() + (z - y) * inset;
    let roof_top = corner + y * ((-inset - corner.y) / y.y);
    ring.extend([Point2::new(end, inset - outline.width), Point2::new(end, -inset), roof_top]);
    if inset == 0.0 {
        ring.push(outline.corner() + y * outline.roof);
    }
    ring.push(corner);
    ring
}
