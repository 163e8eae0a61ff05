//! Latch: parts of the plug on an elastic flexure.

use super::Part;
use super::geometry::Axis;
use super::raw_part::MIN_EXTENT;
use input::units::read::{gpa, mm};
use input::{Check, InputError};
use nalgebra::{Point3, Vector3};
use serde::Deserialize;

/// Characteristic radius factor of the pseudo-rigid-body model of a cantilever with an end load (Howell
/// 2001, Compliant Mechanisms, Wiley, Sec. 5.2.1): distance of the hinge from the end, as a share of
/// the cantilever's length. The end of the model is 4 % stiffer than `3 E I / L^3`.
const GAMMA: f64 = 0.85;
/// Stiffness coefficient of the pseudo-rigid-body model.
const K_THETA: f64 = 2.65;
/// Largest component of a flexure along the axis about which it bends, as a share of its length.
const MAX_SLANT: f64 = 0.05;

/// Parts of a plug that rotate together about a hinge with a spring.
#[derive(Debug, Clone, PartialEq)]
pub struct Latch {
    /// Indices of the latch's parts among those of the plug, ascending.
    pub parts: Vec<usize>,
    /// Point on the hinge's axis, plug frame, m.
    pub hinge: Point3<f64>,
    /// Axis of rotation (0 x, 1 y, 2 z).
    pub axis: usize,
    /// Stiffness of the hinge, N m/rad.
    pub stiffness: f64,
    /// Root and end of the flexure, plug frame, m.
    pub flexure: [Point3<f64>; 2],
}

/// Latch in a task file: names of its parts, and the flexure that carries them; SI units.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawLatch {
    parts: Vec<String>,
    axis: Axis,
    #[serde(rename = "root_mm", deserialize_with = "mm")]
    root: [f64; 3],
    #[serde(rename = "end_mm", deserialize_with = "mm")]
    end: [f64; 3],
    #[serde(rename = "width_mm", deserialize_with = "mm")]
    width: f64,
    #[serde(rename = "thickness_mm", deserialize_with = "mm")]
    thickness: f64,
    #[serde(rename = "modulus_gpa", deserialize_with = "gpa")]
    modulus: f64,
}

/// Returns the stiffness of the hinge that replaces a cantilever, N m/rad; sizes in m, modulus in Pa.
fn stiffness(length: f64, width: f64, thickness: f64, modulus: f64) -> f64 {
    let second_moment = width * thickness.powi(3) / 12.0;
    GAMMA * K_THETA * modulus * second_moment / length
}

/// Checks a latch and replaces its flexure by a hinge.
pub fn check_latch(check: Check<'_>, raw: &RawLatch, parts: &[Part]) -> Result<Latch, InputError> {
    let fail = |problem: String| check.fail("plug.latch.parts", problem);
    let mut indices = Vec::new();
    for name in &raw.parts {
        let named = |part: &Part| part.name == *name;
        match parts.iter().position(named) {
            None => return fail(format!("the plug has no part {name:?}")),
            Some(i) if indices.contains(&i) || parts[i + 1..].iter().any(named) => {
                return fail(format!("{name:?} is given twice"));
            }
            Some(i) => indices.push(i),
        }
    }
    if indices.is_empty() || indices.len() == parts.len() {
        return fail("must be some of the plug's parts, not all".to_owned());
    }
    indices.sort_unstable();
    let [root, end] = [raw.root, raw.end].map(Vector3::from);
    let along = end - root;
    let (axis, length) = (raw.axis as usize, along.norm());
    if length < MIN_EXTENT {
        return check.fail("plug.latch.end_mm", "must be at least 0.001 mm from root_mm");
    }
    if along[axis].abs() > MAX_SLANT * length {
        return check.fail("plug.latch.axis", "is along the flexure; it must be across it");
    }
    if raw.thickness > 0.5 * length {
        let problem = "must be at most half the flexure's length, as that of a beam";
        return check.fail("plug.latch.thickness_mm", problem);
    }
    let stiffness = stiffness(length, raw.width, raw.thickness, raw.modulus);
    let hinge = Point3::from(end - along * GAMMA);
    Ok(Latch { parts: indices, hinge, axis, stiffness, flexure: [root, end].map(Point3::from) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::units::{GPA, MM};

    /// A force at the end of a cantilever deflects the end by `F L^3 / 3 E I`. With the hinge the deflection is 4 %
    /// less, since the model is fitted to large deflections.
    #[test]
    fn a_latch_is_as_stiff_at_its_end_as_the_cantilever() {
        let [length, width, thickness, modulus] = [8.4 * MM, 3.2 * MM, 1.2 * MM, 2.4 * GPA];
        let beam = 3.0 * modulus * width * thickness.powi(3) / 12.0 / length.powi(3);
        let hinge = stiffness(length, width, thickness, modulus) / (GAMMA * length).powi(2);
        assert!((hinge / beam - 1.04).abs() < 5e-3, "{hinge} and {beam} N/m");
    }
}
