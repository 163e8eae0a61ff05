//! F3: independence of the mesh.

use super::{finray9, infill};
use crate::{CheckRow, Tolerance};
use finray::elasticity::{PlaneStress, Slab};
use finray::geometry::Geometry;
use finray::mechanics::{CROSS_SIZE, SIZE};
use finray::meshed::{RigidFace, rigid_stiffness};
use finray::plate::MindlinPlate;
use nalgebra::Matrix3;

/// Designs: density, percent, and direction, degrees.
const DESIGNS: [[f64; 2]; 4] = [[10.0, 30.0], [20.0, 20.0], [30.0, 0.0], [30.0, 40.0]];
/// Largest change of an entry, percent of the springs that it couples.
const CHANGE_PERCENT: f64 = 2.0;
/// Rounding, as a share of the springs that an entry couples.
const ROUNDING: f64 = 1e-9;

pub fn f3() -> Vec<CheckRow> {
    let row = |text: &str, measured: Option<f64>, unit, allowed| {
        CheckRow::new("F3", text, 0.0, measured.ok_or(()), unit, Tolerance::Absolute(allowed))
    };
    let found = DESIGNS.map(halved);
    let changes = DESIGNS.iter().zip(&found).map(|([density, direction], halved)| {
        let text = format!("half the mesh, {density} %, {direction} deg");
        let change = halved.as_ref().map(|[coarse, fine]| {
            let changes = coarse.iter().zip(fine).map(|(coarse, fine)| difference(coarse, fine));
            100.0 * changes.fold(0.0, f64::max)
        });
        row(&text, change, "%", CHANGE_PERCENT)
    });
    let coarse = found.iter().map(|halved| Some(halved.as_ref()?[0]));
    let all = coarse.collect::<Option<Vec<_>>>().map(|designs| designs.concat());
    let asymmetry = all.as_ref().map(|all| {
        all.iter().map(|matrix| difference(matrix, &matrix.transpose())).fold(0.0, f64::max)
    });
    let indefinite = all
        .as_ref()
        .map(|all| all.iter().filter(|matrix| matrix.cholesky().is_none()).count() as f64);
    let whole = [
        row("stiffness matrices, most asymmetric entry", asymmetry, "-", ROUNDING),
        row("stiffness matrices not positive definite", indefinite, "-", 0.0),
    ];
    changes.chain(whole).collect()
}

/// Matrices of a design (pad; pad and roof; across the plane) on a mesh and at half its size.
fn halved(design: [f64; 2]) -> Option<[[Matrix3<f64>; 3]; 2]> {
    let geometry = infill(&finray9()?, design)?;
    Some([matrices(&geometry, 1.0)?, matrices(&geometry, 0.5)?])
}

/// Matrices before they are made exactly symmetric.
fn matrices(geometry: &Geometry, factor: f64) -> Option<[Matrix3<f64>; 3]> {
    let slab = Slab::of(&geometry.finger);
    let (plane, plate) = (PlaneStress(slab), MindlinPlate(slab));
    let faces = [RigidFace::Pad, RigidFace::PadAndRoof];
    let [pad, both] = rigid_stiffness(geometry, &plane, SIZE * factor, faces).ok()?;
    let [across] = rigid_stiffness(geometry, &plate, CROSS_SIZE * factor, [RigidFace::Pad]).ok()?;
    Some([pad, both, across])
}

/// Returns the largest difference of two matrices, relative to the springs that the entry couples.
fn difference(a: &Matrix3<f64>, b: &Matrix3<f64>) -> f64 {
    let entry = |(i, j)| (a[(i, j)] - b[(i, j)]).abs() / (b[(i, i)] * b[(j, j)]).sqrt();
    (0..9).map(|n| entry((n / 3, n % 3))).fold(0.0, f64::max)
}
