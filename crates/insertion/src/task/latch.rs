//! A latch that springs: parts of the plug on a flexure.

use super::Part;
use super::geometry::Axis;
use super::quantity::size;
use input::units::{GPA, MM};
use input::{Check, InputError};
use nalgebra::{Point3, Vector3};
use serde::Deserialize;

/// Where a cantilever that is loaded at its end seems to turn, as a share of its length from the
/// end, and its stiffness there in units of `E I / L` per that share: the pseudo-rigid-body model
/// (Howell 2001, Compliant Mechanisms, Wiley, Sec. 5.2.1). Its end is 4 % stiffer than `3 E I / L^3`.
const GAMMA: f64 = 0.85;
const K_THETA: f64 = 2.65;
/// Most that a flexure may lean towards the axis about which it bends, as a share of its length.
const SLANT: f64 = 0.05;

/// Parts of a plug that turn together about a hinge against a spring.
#[derive(Debug, Clone, PartialEq)]
pub struct Latch {
    /// Which of the plug's parts, in their order.
    pub parts: Vec<usize>,
    /// A point on the hinge's axis, plug frame, m.
    pub hinge: Point3<f64>,
    /// Axis about which it turns (0 x, 1 y, 2 z).
    pub axis: usize,
    /// Stiffness of the hinge, N m/rad.
    pub stiffness: f64,
    /// Root and end of its flexure, plug frame, m.
    pub flexure: [Point3<f64>; 2],
}

/// The latch as written: its parts, and the flexure that carries them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawLatch {
    parts: Vec<String>,
    axis: Axis,
    root_mm: [f64; 3],
    end_mm: [f64; 3],
    width_mm: f64,
    thickness_mm: f64,
    modulus_gpa: f64,
}

/// Stiffness of the hinge that stands for a cantilever, N m/rad; sizes in m, modulus in Pa.
fn stiffness(length: f64, width: f64, thickness: f64, modulus: f64) -> f64 {
    let second_moment = width * thickness.powi(3) / 12.0;
    GAMMA * K_THETA * modulus * second_moment / length
}

pub fn latch(check: Check<'_>, raw: &RawLatch, parts: &[Part]) -> Result<Latch, InputError> {
    let mut found = Vec::new();
    for name in &raw.parts {
        let named = |part: &Part| part.name == *name;
        match parts.iter().position(named) {
            None => {
                let problem = format!("names {name:?}; the plug has no part of that name");
                return check.fail("plug.latch.parts", problem);
            }
            Some(i) if found.contains(&i) || parts[i + 1..].iter().any(named) => {
                return check.fail("plug.latch.parts", format!("{name:?} stands for two"));
            }
            Some(i) => found.push(i),
        }
    }
    if found.is_empty() || found.len() == parts.len() {
        return check.fail("plug.latch.parts", "must be some of the plug's parts, not all");
    }
    found.sort_unstable();
    let point = |key, point| Ok(Vector3::from(check.each(key, point, Check::distance)?) * MM);
    let root = point("plug.latch.root_mm", raw.root_mm)?;
    let end = point("plug.latch.end_mm", raw.end_mm)?;
    let along = end - root;
    let axis = raw.axis as usize;
    let length = size(check, "plug.latch.end_mm: its distance from root_mm", along.norm() / MM)?;
    if along[axis].abs() > SLANT * length {
        return check.fail("plug.latch.axis", "lies along the flexure; it bends across it");
    }
    let width = size(check, "plug.latch.width_mm", raw.width_mm)?;
    let thickness = size(check, "plug.latch.thickness_mm", raw.thickness_mm)?;
    if thickness > 0.5 * length {
        let key = "plug.latch.thickness_mm";
        return check.fail(key, "is more than half the flexure's length; that is no beam");
    }
    let modulus = check.positive("plug.latch.modulus_gpa", raw.modulus_gpa)? * GPA;
    let hinge = Point3::from(end - along * GAMMA);
    let stiffness = stiffness(length, width, thickness, modulus);
    let flexure = [root, end].map(Point3::from);
    Ok(Latch { parts: found, hinge, axis, stiffness, flexure })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A force at the end of a cantilever moves it by `F L^3 / 3 E I`; of the hinge that stands for
    /// it by 4 % less, and turns it as much as makes up for that over a large deflection.
    #[test]
    fn a_latch_is_as_stiff_at_its_end_as_the_cantilever() {
        let [length, width, thickness, modulus] = [8.4 * MM, 3.2 * MM, 1.2 * MM, 2.4 * GPA];
        let beam = 3.0 * modulus * width * thickness.powi(3) / 12.0 / length.powi(3);
        let hinge = stiffness(length, width, thickness, modulus) / (GAMMA * length).powi(2);
        assert!((hinge / beam - 1.04).abs() < 5e-3, "{hinge} and {beam} N/m");
    }
}
