//! Mechanics against solids; `tests/analytic` has the exact solutions.

mod geometry;
mod holes;
mod solid;

use super::geometry::Geometry;
use super::infill::InfillDesign;
use crate::condense::{Role, condense};
use crate::elasticity::{PlaneStress, Slab};
use crate::mechanics::compute;
use crate::mesh::{Mesh, MeshError};
use crate::printed::PrintedFinger;
use nalgebra::Point2;

/// The shipped finger.
fn finray9() -> PrintedFinger {
    let text = include_str!("../../../../fingers/finray9.toml");
    PrintedFinger::parse(text, "fingers/finray9.toml").unwrap()
}

/// The shipped finger with an infill.
fn infill(density_percent: f64, direction_deg: f64) -> Geometry {
    let design = InfillDesign { density_percent, direction_deg, phase_mm: None };
    Geometry::new(&finray9(), &design).unwrap()
}

#[test]
fn a_modulus_in_other_units_is_asked_about() {
    let mut geometry = infill(20.0, 20.0);
    geometry.finger.material.modulus *= 1e-3;
    let error = compute(&geometry).unwrap_err().to_string();
    assert!(error.contains("units look wrong") && error.contains("modulus_gpa"), "{error}");
}

/// The print sheet has room for two decimals.
#[test]
fn the_angle_of_a_slicer_has_no_more_digits_than_that_of_the_design() {
    let settings = crate::export::slicer::settings(&infill(20.0, 58.2));
    assert!(settings.contains(&("fill_angle", "infill_direction", "31.8".to_owned())));
}

/// A finger without stiffness has a mesh, which the message must not blame.
#[test]
fn an_error_of_the_stiffness_does_not_name_the_mesh() {
    let mut geometry = infill(20.0, 20.0);
    geometry.finger.material.modulus = 0.0;
    let error = compute(&geometry).unwrap_err().to_string();
    assert_eq!(error, format!("fingers/finray9.toml: {}", MeshError::Disconnected));
    assert!(!error.contains("mesh"), "{error}");
}

#[test]
fn what_is_held_by_nothing_is_an_error() {
    let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
    let mesh = Mesh::new(&square.to_vec(), &[], 0.3).unwrap();
    let roles = vec![Role::Free; mesh.nodes.len()];
    let element = PlaneStress(Slab { modulus: 2e9, poisson: 0.4, thickness: 0.012 });
    assert_eq!(condense(&mesh, &element, &roles, false).err(), Some(MeshError::Disconnected));
}
