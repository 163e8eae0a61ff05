//! Stiffness of a printed finger from its ribs.
//!
//! The profile is in plane stress under loads in its plane, and a Mindlin plate under loads out of the plane. Both
//! models use quadratic triangles on the exact profile. The base is clamped, and the pad (or the pad and a section of
//! the roof) moves as a rigid body.

use super::elasticity::{PlaneStress, Slab};
use super::geometry::Geometry;
use super::infill::{InfillDesign, RibLines};
use super::mesh::MeshError;
use super::meshed::{RigidFace, rigid_stiffness};
use super::plate::MindlinPlate;
use super::stiffness::{CrossStiffness, PlanarStiffness};
use crate::printed::PrintedFinger;
use input::InputError;
use input::units::{MM, N_PER_MM};
use rayon::prelude::*;

/// Side length of the triangles, m: halving it changes no entry of a stiffness matrix by
/// more than 2 % of the springs it couples.
pub const SIZE: f64 = 0.4 * MM;
/// Side length of the triangles for loads out of the plane, m: the walls act as deep beams and need fewer triangles.
pub const CROSS_SIZE: f64 = 1.2 * MM;
/// Accepted compliance stiffness (along y, with z and rx free), N/mm: that of fingers for a hand-sized gripper.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.05..=100.0;
/// Number of evaluated phases, evenly spaced over one pitch, starting at that of the finger file.
const PHASES: usize = 8;

/// Computed stiffness of a finger with the modulus of its file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingerStiffness {
    /// In the plane, with the part touching the pad only.
    pub pad: PlanarStiffness,
    /// In the plane, with the part touching pad and roof.
    pub pad_and_roof: PlanarStiffness,
    /// Out of the plane, with the part touching the pad.
    pub cross: CrossStiffness,
}

/// Computes the stiffness of a finger.
///
/// # Errors
/// If the profile cannot be meshed or is not connected to its base, or its stiffness is implausible
/// for a finger, for example because a length or the modulus is given in a wrong unit.
pub fn compute(geometry: &Geometry) -> Result<FingerStiffness, InputError> {
    let [pad, pad_and_roof] = planar(geometry)?;
    Ok(FingerStiffness { pad, pad_and_roof, cross: cross(geometry)? })
}

/// Returns the stiffness in the plane with the part touching the pad only, and with it touching pad and roof.
///
/// # Errors
/// See [`compute`].
pub fn planar(geometry: &Geometry) -> Result<[PlanarStiffness; 2], InputError> {
    let fails = |problem: MeshError| geometry.finger.fault(problem);
    let element = PlaneStress(Slab::of(&geometry.finger));
    let held = rigid_stiffness(geometry, &element, SIZE, [RigidFace::Pad, RigidFace::PadAndRoof])
        .map_err(fails)?;
    let stiffness =
        |matrix| PlanarStiffness::new(matrix).ok_or_else(|| fails(MeshError::NotPositiveDefinite));
    let pad = stiffness(held[0])?;
    let compliance = pad.in_compliance() / N_PER_MM;
    if !PLAUSIBLE.contains(&compliance) {
        let problem = format!(
            "the units look wrong: the computed compliance stiffness is {compliance:.3e} N/mm; a \
             finger has 0.05 to 100 N/mm; check that lengths are in mm and material.modulus_gpa in \
             GPa (PETG has 2)"
        );
        return Err(geometry.finger.fault(problem));
    }
    Ok([pad, stiffness(held[1])?])
}

/// Returns the stiffness out of the plane.
///
/// # Errors
/// If the profile cannot be meshed or is not connected to its base.
pub fn cross(geometry: &Geometry) -> Result<CrossStiffness, InputError> {
    let fails = |problem: MeshError| geometry.finger.fault(problem);
    let element = MindlinPlate(Slab::of(&geometry.finger));
    let [held] =
        rigid_stiffness(geometry, &element, CROSS_SIZE, [RigidFace::Pad]).map_err(fails)?;
    CrossStiffness::new(held).ok_or_else(|| fails(MeshError::NotPositiveDefinite))
}

/// Returns the stiffness in the plane ([`planar`]) for the positions of the first rib that a slicer can choose: at
/// 8 phases, evenly spaced over one pitch.
///
/// # Errors
/// See [`Geometry::new`] and [`planar`].
pub fn over_phases(
    finger: &PrintedFinger,
    density_percent: f64,
    direction_deg: f64,
) -> Result<Vec<[PlanarStiffness; 2]>, InputError> {
    let design = InfillDesign { density_percent, direction_deg, phase_mm: None };
    // A density of 0 has no finite pitch: the first geometry returns the error.
    let pitch = RibLines::new(finger, &design).pitch;
    let at = |share: f64| {
        let phase = finger.ribs.phase + share * pitch;
        let phase_mm = (share > 0.0).then_some(phase / MM);
        planar(&Geometry::new(finger, &InfillDesign { phase_mm, ..design })?)
    };
    // Collected in the order of the phases, so that the first of several errors is returned.
    let all: Vec<_> = (0..PHASES).into_par_iter().map(|i| at(i as f64 / PHASES as f64)).collect();
    all.into_iter().collect()
}
