//! F1: a cantilever (Timoshenko 1921, Phil. Mag. 41:744), a frame, and a wall on edge that
//! bends and twists (Vlasov 1961, Thin-Walled Elastic Beams).
//!
//! F2, the patch test (Irons and Razzaque 1972): under any even strain displacements inside and
//! the work done are exact, whatever the mesh.

use crate::{CheckRow, Tolerance};
use finray::condense::{Condensed, Element, Role, condense};
use finray::elasticity::{PlaneStress, Slab};
use finray::mesh::Mesh;
use finray::plate::MindlinPlate;
use finray::polygon::{Ring, area};
use nalgebra::{DMatrix, DVector, Matrix3, Point2};
use std::collections::BTreeSet;

const E: f64 = 2e9;
const NU: f64 = 0.4;
const DEPTH: f64 = 0.012;
/// Shear modulus, N/m2.
const G: f64 = E / 2.0 / (1.0 + NU);
/// Shear factor of a rectangular section.
const SHEAR: f64 = 5.0 / 6.0;
/// Largest distance of a node on a line, m.
const ON: f64 = 1e-9;

/// Slab of PETG, as deep as the finger.
const SLAB: Slab = Slab { modulus: E, poisson: NU, thickness: DEPTH };
const PLANE: PlaneStress = PlaneStress(SLAB);
const PLATE: MindlinPlate = MindlinPlate(SLAB);

fn rectangle(x: [f64; 2], y: [f64; 2]) -> Ring {
    [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]
        .map(|(x, y)| Point2::new(x, y))
        .to_vec()
}

pub fn f1() -> Vec<CheckRow> {
    [cantilever(), frame(), wall()].concat()
}

fn row(
    text: &str,
    expected: f64,
    matrix: Option<Matrix3<f64>>,
    place: (usize, usize),
    (unit, scale): (&'static str, f64),
    share: f64,
) -> CheckRow {
    let measured = matrix.map(|matrix| matrix[place] * scale).ok_or(());
    let tolerance = Tolerance::Relative(share);
    CheckRow::new("F1", text, expected * scale, measured, unit, tolerance)
}

/// Returns the stiffness of a rigid end (its motions by `follow`), the other end clamped.
fn end<Of: Element>(
    (ring, size): (&Ring, f64),
    element: &Of,
    role: impl Fn(&Point2<f64>) -> Role,
    follow: impl Fn(&Point2<f64>, usize) -> [f64; 3],
) -> Option<Matrix3<f64>> {
    let mesh = Mesh::new(ring, &[], size).ok()?;
    let roles: Vec<Role> = mesh.nodes.iter().map(role).collect();
    let Condensed { nodes, stiffness, .. } = condense(&mesh, element, &roles, false).ok()?;
    let motion = DMatrix::from_fn(stiffness.nrows(), 3, |row, column| {
        let node = mesh.nodes[nodes[row / Of::DOFS] as usize];
        follow(&node, row % Of::DOFS)[column]
    });
    Some((motion.transpose() * stiffness * motion).fixed_view::<3, 3>(0, 0).into_owned())
}

/// Clamped where a coordinate is 0, held where it has reached `end`.
fn clamped_and_held(place: f64, end: f64) -> Role {
    match place {
        place if place < ON => Role::Fixed,
        place if place > end - ON => Role::Kept,
        _ => Role::Free,
    }
}

/// Returns X, Y and the turn about Z of a body at a point.
fn in_plane(at: Point2<f64>) -> impl Fn(&Point2<f64>, usize) -> [f64; 3] {
    move |p, freedom| match freedom {
        0 => [1.0, 0.0, at.y - p.y],
        _ => [0.0, 1.0, p.x - at.x],
    }
}

fn cantilever() -> Vec<CheckRow> {
    let (length, width) = (0.02, 0.001);
    let ring = rectangle([0.0, length], [0.0, width]);
    let role = |p: &Point2<f64>| clamped_and_held(p.x, length);
    let stiffness = end((&ring, 0.0005), &PLANE, role, in_plane(Point2::new(length, width / 2.0)));
    let found = stiffness.and_then(|matrix| matrix.try_inverse());
    let (area, inertia) = (DEPTH * width, DEPTH * width.powi(3) / 12.0);
    let across = length.powi(3) / (3.0 * E * inertia) + length / (G * area * SHEAR);
    let turned = length.powi(2) / (2.0 * E * inertia);
    [
        ("cantilever, stretch", length / (E * area), (0, 0), ("mm/N", 1e3)),
        ("cantilever, deflection", across, (1, 1), ("mm/N", 1e3)),
        ("cantilever, turn by a force", turned, (1, 2), ("rad/N", 1.0)),
        ("cantilever, turn", length / (E * inertia), (2, 2), ("rad/Nm", 1.0)),
    ]
    .map(|(text, expected, place, unit)| row(text, expected, found, place, unit, 0.01))
    .to_vec()
}

/// Two slender legs under a block that is stiff against them: each is clamped at both ends,
/// 12 E I / h^3, and their stretching holds the block against turning.
fn frame() -> Vec<CheckRow> {
    let (height, width, leg) = (0.04, 0.03, 0.0005);
    let o = rectangle([0.0, width], [0.0, height + 0.01]);
    let i = rectangle([leg, width - leg], [0.0, height]);
    // The opening reaches the foot: the outline goes around it.
    let [left, right] = [0.0, width].map(|x| Point2::new(x, height));
    let ring: Ring = vec![o[0], i[0], i[3], i[2], i[1], o[1], right, o[2], o[3], left];
    let role = |p: &Point2<f64>| clamped_and_held(p.y, height);
    let found = end((&ring, 0.0007), &PLANE, role, in_plane(Point2::new(width / 2.0, height)));
    let (area, inertia) = (DEPTH * leg, DEPTH * leg.powi(3) / 12.0);
    let arm = (width - leg) / 2.0;
    let turn = 2.0 * (E * area / height * arm * arm + 4.0 * E * inertia / height);
    [
        ("frame, sway", 24.0 * E * inertia / height.powi(3), (0, 0), ("N/mm", 1e-3)),
        ("frame, upright", 2.0 * E * area / height, (1, 1), ("N/mm", 1e-3)),
        ("frame, turn", turn, (2, 2), ("Nm/rad", 1.0)),
    ]
    .map(|(text, expected, place, unit)| row(text, expected, found, place, unit, 0.01))
    .to_vec()
}

/// Loaded across the plane: bending, shear and torsion of a deep beam.
fn wall() -> Vec<CheckRow> {
    let (length, width) = (0.04, 0.0006);
    let ring = rectangle([0.0, length], [0.0, width]);
    let role = |p: &Point2<f64>| clamped_and_held(p.x, length);
    // Deflection along Z, turns about X and Y.
    let follow = |p: &Point2<f64>, freedom: usize| match freedom {
        0 => [1.0, p.y - width / 2.0, length - p.x],
        1 => [0.0, 1.0, 0.0],
        _ => [0.0, 0.0, 1.0],
    };
    let stiffness = end((&ring, 0.0006), &PLATE, role, follow);
    let found = stiffness.and_then(|matrix| matrix.try_inverse());
    let (area, inertia) = (DEPTH * width, width * DEPTH.powi(3) / 12.0);
    let deflection = length.powi(3) / (3.0 * E * inertia) + length / (G * area * SHEAR);
    let torsion = G * SHEAR * DEPTH * width.powi(3) / 3.0;
    // Its ends do not warp: it is as stiff as one shorter by twice the decay length.
    let warping = (width * DEPTH).powi(3) / 144.0;
    let twist = (length - 2.0 * (E * warping / torsion).sqrt()) / torsion;
    vec![
        row("wall on edge, deflection", deflection, found, (0, 0), ("mm/N", 1e3), 0.01),
        row("wall on edge, turn", length / (E * inertia), found, (2, 2), ("rad/Nm", 1.0), 0.01),
        row("wall on edge, twist", twist, found, (1, 1), ("rad/Nm", 1.0), 0.02),
    ]
}

/// Returns the displacement of an even strain by place.
fn field(p: &Point2<f64>) -> [f64; 2] {
    [0.1 * p.x + 0.3 * p.y, -0.2 * p.x + 0.4 * p.y]
}

/// Strains of that field: XX, YY and the shear.
const STRAIN: [f64; 3] = [0.1, 0.4, 0.3 - 0.2];

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

/// Returns the largest error of a displacement, and twice the work, with the edges moved evenly.
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
