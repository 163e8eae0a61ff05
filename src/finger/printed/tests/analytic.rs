//! Beams, a frame and the patch test: solutions known in closed form.

use crate::finger::printed::condense::{Condensed, Element, Role, condense};
use crate::finger::printed::elasticity::PlaneStress;
use crate::finger::printed::mesh::Mesh;
use crate::finger::printed::plate::MindlinPlate;
use crate::finger::printed::polygon::Ring;
use nalgebra::{DMatrix, DVector, Matrix3, Point2};

const E: f64 = 2e9;
const NU: f64 = 0.4;
const DEPTH: f64 = 0.012;
const PLANE: PlaneStress = PlaneStress { modulus: E, poisson: NU, thickness: DEPTH };
const PLATE: MindlinPlate = MindlinPlate { modulus: E, poisson: NU, thickness: DEPTH };

fn rectangle(x: [f64; 2], y: [f64; 2]) -> Ring {
    [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]
        .map(|(x, y)| Point2::new(x, y))
        .to_vec()
}

/// The stiffness of a rigid end (its motions by `follow`), the other end clamped.
fn end<E: Element>(
    mesh: &Mesh,
    element: &E,
    role: impl Fn(&Point2<f64>) -> Role,
    follow: impl Fn(&Point2<f64>, usize) -> [f64; 3],
) -> Matrix3<f64> {
    let roles: Vec<Role> = mesh.nodes.iter().map(role).collect();
    let Condensed { nodes, stiffness, .. } = condense(mesh, element, &roles, false).unwrap();
    let motion = DMatrix::from_fn(stiffness.nrows(), 3, |row, column| {
        let node = mesh.nodes[nodes[row / E::FREEDOMS] as usize];
        follow(&node, row % E::FREEDOMS)[column]
    });
    (motion.transpose() * stiffness * motion).fixed_view::<3, 3>(0, 0).into_owned()
}

/// X, Y and the turn about Z of a body at a point.
fn in_plane(at: Point2<f64>) -> impl Fn(&Point2<f64>, usize) -> [f64; 3] {
    move |p, freedom| match freedom {
        0 => [1.0, 0.0, at.y - p.y],
        _ => [0.0, 1.0, p.x - at.x],
    }
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() < tolerance, "{found}, not {expected}");
}

#[test]
fn a_cantilever_bends_and_stretches_as_timoshenkos_beam() {
    let (length, width) = (0.02, 0.001);
    let mesh = Mesh::new(&rectangle([0.0, length], [0.0, width]), &[], 0.0005).unwrap();
    let role = |p: &Point2<f64>| match p.x {
        x if x < 1e-9 => Role::Fixed,
        x if x > length - 1e-9 => Role::Kept,
        _ => Role::Free,
    };
    let at = Point2::new(length, width / 2.0);
    let compliance = end(&mesh, &PLANE, role, in_plane(at)).try_inverse().unwrap();
    let (area, inertia) = (DEPTH * width, DEPTH * width.powi(3) / 12.0);
    let shear = E / 2.0 / (1.0 + NU) * area * 5.0 / 6.0;
    close(compliance[(0, 0)], length / (E * area), 0.01);
    close(compliance[(1, 1)], length.powi(3) / (3.0 * E * inertia) + length / shear, 0.01);
    close(compliance[(1, 2)], length.powi(2) / (2.0 * E * inertia), 0.01);
    close(compliance[(2, 2)], length / (E * inertia), 0.01);
}

/// Two slender legs under a block that is stiff against them: each is clamped at both ends,
/// 12 E I / h^3, and their stretching holds the block against turning.
#[test]
fn a_frame_sways_as_its_legs_bend() {
    let (height, width, leg) = (0.04, 0.03, 0.0005);
    let outer = rectangle([0.0, width], [0.0, height + 0.01]);
    let opening = rectangle([leg, width - leg], [0.0, height]);
    // The opening reaches the foot: the outline goes around it.
    let [left, right] = [0.0, width].map(|x| Point2::new(x, height));
    let (o, i) = (outer, opening);
    let outer: Ring = vec![o[0], i[0], i[3], i[2], i[1], o[1], right, o[2], o[3], left];
    let mesh = Mesh::new(&outer, &[], 0.0007).unwrap();
    let role = |p: &Point2<f64>| match p.y {
        y if y < 1e-9 => Role::Fixed,
        y if y > height - 1e-9 => Role::Kept,
        _ => Role::Free,
    };
    let at = Point2::new(width / 2.0, height);
    let stiffness = end(&mesh, &PLANE, role, in_plane(at));
    let (area, inertia) = (DEPTH * leg, DEPTH * leg.powi(3) / 12.0);
    close(stiffness[(0, 0)], 2.0 * 12.0 * E * inertia / height.powi(3), 0.01);
    close(stiffness[(1, 1)], 2.0 * E * area / height, 0.01);
    let arm = (width - leg) / 2.0;
    let turn = 2.0 * (E * area / height * arm * arm + 4.0 * E * inertia / height);
    close(stiffness[(2, 2)], turn, 0.01);
}

/// A wall on edge, loaded across the plane: bending, shear and torsion of a deep beam.
#[test]
fn a_wall_on_edge_bends_and_twists_as_a_deep_beam() {
    let (length, width) = (0.04, 0.0006);
    let mesh = Mesh::new(&rectangle([0.0, length], [0.0, width]), &[], 0.0006).unwrap();
    let role = |p: &Point2<f64>| match p.x {
        x if x < 1e-9 => Role::Fixed,
        x if x > length - 1e-9 => Role::Kept,
        _ => Role::Free,
    };
    // Deflection along Z, turns about X and Y.
    let follow = |p: &Point2<f64>, freedom: usize| match freedom {
        0 => [1.0, p.y - width / 2.0, length - p.x],
        1 => [0.0, 1.0, 0.0],
        _ => [0.0, 0.0, 1.0],
    };
    let compliance = end(&mesh, &PLATE, role, follow).try_inverse().unwrap();
    let (area, inertia) = (DEPTH * width, width * DEPTH.powi(3) / 12.0);
    let shear_modulus = E / 2.0 / (1.0 + NU);
    let shear = shear_modulus * area * 5.0 / 6.0;
    close(compliance[(0, 0)], length.powi(3) / (3.0 * E * inertia) + length / shear, 0.01);
    close(compliance[(2, 2)], length / (E * inertia), 0.01);
    let torsion = shear_modulus * 5.0 / 6.0 * DEPTH * width.powi(3) / 3.0;
    // Its ends do not warp: it is as stiff as one shorter by twice the decay length (Vlasov
    // 1961, Thin-Walled Elastic Beams).
    let warping = (width * DEPTH).powi(3) / 144.0;
    let free = length - 2.0 * (E * warping / torsion).sqrt();
    close(compliance[(1, 1)], free / torsion, 0.02);
}

/// Any even strain is met exactly: displacements inside and the work done.
#[test]
fn the_patch_test_is_passed() {
    let hole = [(0.4, 0.3), (0.5, 0.7), (0.8, 0.4)].map(|(x, y)| Point2::new(x, y)).to_vec();
    let mesh = Mesh::new(&rectangle([0.0, 1.3], [0.0, 1.0]), &[hole], 0.2).unwrap();
    let edge: std::collections::BTreeSet<usize> = mesh.boundary().into_iter().flatten().collect();
    let role = |node| if edge.contains(&node) { Role::Kept } else { Role::Free };
    let roles: Vec<Role> = (0..mesh.nodes.len()).map(role).collect();
    let field = |p: &Point2<f64>| [0.1 * p.x + 0.3 * p.y, -0.2 * p.x + 0.4 * p.y];
    let condensed = condense(&mesh, &PLANE, &roles, true).unwrap();
    let kept = DVector::from_iterator(
        2 * condensed.nodes.len(),
        condensed.nodes.iter().flat_map(|&node| field(&mesh.nodes[node as usize])),
    );
    for (node, found) in mesh.nodes.iter().zip(condensed.expand(&kept).chunks(2)) {
        let expected = field(node);
        assert!((found[0] - expected[0]).abs() + (found[1] - expected[1]).abs() < 1e-12);
    }
    let (xx, yy, xy) = (0.1, 0.4, 0.3 - 0.2);
    let plane = E * DEPTH / (1.0 - NU * NU);
    let density = xx * xx + yy * yy + 2.0 * NU * xx * yy + (1.0 - NU) / 2.0 * xy * xy;
    let work = (kept.transpose() * &condensed.stiffness * &kept)[0];
    close(work, plane * density * mesh.area(), 1e-10);
}

#[test]
fn what_is_held_by_nothing_is_an_error() {
    let mesh = Mesh::new(&rectangle([0.0, 1.0], [0.0, 1.0]), &[], 0.3).unwrap();
    let roles = vec![Role::Free; mesh.nodes.len()];
    assert!(condense(&mesh, &PLANE, &roles, false).is_err());
}
