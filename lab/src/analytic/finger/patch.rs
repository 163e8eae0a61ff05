//! F2, the patch test (Irons and Razzaque 1972): under any even strain displacements inside and
//! the work done are exact, whatever the mesh.

use super::super::{CheckRow, Tolerance};
use super::beams::{PLANE, SLAB, rectangle};
use finray::condense::{Role, condense};
use finray::mesh::Mesh;
use finray::polygon::{Ring, area};
use nalgebra::{DVector, Point2};
use std::collections::BTreeSet;

/// Displacement of an even strain by place.
fn field(p: &Point2<f64>) -> [f64; 2] {
    [0.1 * p.x + 0.3 * p.y, -0.2 * p.x + 0.4 * p.y]
}

/// Strains of that field: XX, YY and the shear.
const STRAIN: [f64; 3] = [0.1, 0.4, 0.3 - 0.2];

/// Errors of the patch test, F2 rows.
pub fn f2() -> Vec<CheckRow> {
    let [xx, yy, xy] = STRAIN;
    let (nu, width, height) = (SLAB.poisson, 1.3, 1.0);
    let plane = SLAB.modulus * SLAB.thickness / (1.0 - nu * nu);
    let density = xx * xx + yy * yy + 2.0 * nu * xx * yy + (1.0 - nu) / 2.0 * xy * xy;
    let hole: Ring = [(0.4, 0.3), (0.5, 0.7), (0.8, 0.4)].map(|(x, y)| Point2::new(x, y)).to_vec();
    let outer = rectangle([0.0, width], [0.0, height]);
    let solid = area(&outer) - area(&hole).abs();
    let found = Mesh::new(&outer, &[hole], 0.2).ok();
    let found = found.and_then(|mesh| patch(&mesh)).ok_or(());
    let (error, work) = (found.map(|found| found[0]), found.map(|found| found[1]));
    let (none, close) = (Tolerance::Absolute(1e-12), Tolerance::Relative(1e-10));
    vec![
        CheckRow::new("F2", "patch test, largest error inside", 0.0, error, "m", none),
        CheckRow::new("F2", "patch test, work", plane * density * solid, work, "J", close),
    ]
}

/// Largest error of a displacement, and twice the work, with the edges moved evenly.
fn patch(mesh: &Mesh) -> Option<[f64; 2]> {
    let edge: BTreeSet<usize> = mesh.boundary().into_iter().flatten().collect();
    let role = |node| if edge.contains(&node) { Role::Kept } else { Role::Free };
    let roles: Vec<Role> = (0..mesh.nodes.len()).map(role).collect();
    let condensed = condense(mesh, &PLANE, &roles, true).ok()?;
    let kept = condensed.nodes.iter().flat_map(|&node| field(&mesh.nodes[node as usize]));
    let kept = DVector::from_iterator(2 * condensed.nodes.len(), kept);
    let moved = condensed.expand(&kept);
    let error = |(node, found): (&Point2<f64>, &[f64])| {
        let expected = field(node);
        (found[0] - expected[0]).abs() + (found[1] - expected[1]).abs()
    };
    let error = mesh.nodes.iter().zip(moved.chunks(2)).map(error).fold(0.0, f64::max);
    Some([error, (kept.transpose() * &condensed.stiffness * &kept)[0]])
}
