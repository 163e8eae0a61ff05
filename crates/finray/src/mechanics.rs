//! The stiffness of a printed finger from its ribs.
//!
//! In its plane the profile is elastic in plane stress; across it, it is Mindlin's plate.
//! Both use quadratic triangles on the exact profile. The base is clamped, and the
//! pad (or the pad and a part of the roof) moves as a rigid body.

use super::FingerError;
use super::elasticity::PlaneStress;
use super::geometry::Geometry;
use super::model::{Body, Follow, Model};
use super::plate::MindlinPlate;
use super::stiffness::{CrossStiffness, PlanarStiffness};
use crate::printed::{Outline, PrintedFinger};
use input::units::{MM, N_PER_MM};

/// Length of a triangle's side, m: halving it changes no entry of a stiffness matrix by
/// more than 2 % of the springs it couples.
pub const SIZE: f64 = 0.4 * MM;
/// The same across the plane, where walls are deep beams and need fewer triangles, m.
pub const CROSS_SIZE: f64 = 1.2 * MM;

/// Compliance stiffness of a finger for a hand-sized gripper, N/mm.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.05..=100.0;

/// What is computed of a finger; free stiffnesses are at the file's modulus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingerStiffness {
    /// In the plane, the part touching the pad alone.
    pub pad: PlanarStiffness,
    /// In the plane, the part touching pad and roof.
    pub pad_and_roof: PlanarStiffness,
    /// Across the plane, the part touching the pad.
    pub cross: CrossStiffness,
    /// Solid area of the profile, m2.
    pub area: f64,
    /// Mass of the whole finger, kg.
    pub mass: f64,
}

/// The stiffness of a finger.
///
/// # Errors
/// If the profile cannot be meshed or hangs in the air, or its stiffness is not that of a
/// finger, as when a length or the modulus is in other units than its key says.
pub fn compute(geometry: &Geometry) -> Result<FingerStiffness, FingerError> {
    let [pad, pad_and_roof] = planar(geometry, SIZE)?;
    Ok(FingerStiffness {
        pad,
        pad_and_roof,
        cross: cross(geometry, CROSS_SIZE)?,
        area: geometry.area(),
        mass: geometry.mass(),
    })
}

/// In the plane, with triangles of a size, m: pad alone; pad and roof.
pub fn planar(geometry: &Geometry, size: f64) -> Result<[PlanarStiffness; 2], FingerError> {
    let fails = |problem: &dyn std::fmt::Display| FingerError::mesh(geometry, problem);
    let model = Model::new(geometry, size).map_err(|error| fails(&error))?;
    let element = PlaneStress::of(&geometry.finger);
    let condensed = model.condense(&element, false).map_err(|error| fails(&error))?;
    let held = |body| {
        let held = model.hold(&condensed, &element, body).map_err(|error| fails(&error))?;
        PlanarStiffness::new(held.stiffness).ok_or_else(|| fails(&"it is not stiff"))
    };
    let pad = held(Body::Pad)?;
    plausible(&geometry.finger, &pad)?;
    Ok([pad, held(Body::PadAndRoof)?])
}

/// Across the plane, with triangles of a size, m.
pub fn cross(geometry: &Geometry, size: f64) -> Result<CrossStiffness, FingerError> {
    let fails = |problem: &dyn std::fmt::Display| FingerError::mesh(geometry, problem);
    let model = Model::new(geometry, size).map_err(|error| fails(&error))?;
    let element = MindlinPlate::of(&geometry.finger);
    let condensed = model.condense(&element, false).map_err(|error| fails(&error))?;
    let held = model.hold(&condensed, &element, Body::Pad).map_err(|error| fails(&error))?;
    CrossStiffness::new(held.stiffness).ok_or_else(|| fails(&"it is not stiff"))
}

fn plausible(finger: &PrintedFinger, pad: &PlanarStiffness) -> Result<(), FingerError> {
    let compliance = pad.in_compliance() / N_PER_MM;
    if PLAUSIBLE.contains(&compliance) {
        return Ok(());
    }
    Err(FingerError::Units { file: finger.file.clone(), compliance })
}

impl PlaneStress {
    /// What fills a finger.
    pub fn of(finger: &PrintedFinger) -> Self {
        PlaneStress {
            modulus: finger.material.modulus,
            poisson: finger.material.poisson,
            thickness: finger.outline.depth,
        }
    }
}

impl MindlinPlate {
    /// What fills a finger.
    pub fn of(finger: &PrintedFinger) -> Self {
        MindlinPlate {
            modulus: finger.material.modulus,
            poisson: finger.material.poisson,
            thickness: finger.outline.depth,
        }
    }
}

impl Follow for PlaneStress {
    /// The body moves along y and z and turns about x = y x z.
    fn follow(&self, outline: &Outline, [at_y, at_z]: [f64; 2]) -> Vec<[f64; 3]> {
        let (y, z) = (outline.out_of_pad(), outline.along_pad());
        let turn = z * at_y - y * at_z;
        (0..2).map(|d| [y[d], z[d], turn[d]]).collect()
    }
}

impl Follow for MindlinPlate {
    /// The body moves along x and turns about y and z. The plate's own deflection is along
    /// -x: its axes X, Y turn the other way than y, z.
    fn follow(&self, outline: &Outline, [at_y, at_z]: [f64; 2]) -> Vec<[f64; 3]> {
        let (y, z) = (outline.out_of_pad(), outline.along_pad());
        // u_x = ry z - rz y
        vec![[-1.0, -at_z, at_y], [0.0, y.x, z.x], [0.0, y.y, z.y]]
    }
}
