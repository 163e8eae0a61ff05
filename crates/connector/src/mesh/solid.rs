//! Convex solids from points: boxes, prisms, hulls.

use crate::body::extent;
use input::units::MM;
use insertion::Solid;
use insertion::task::geometry::{hull, other_axes};
use nalgebra::{Point3, Vector3};

/// Largest difference between coordinates that count as equal, m.
const NEAR: f64 = 1e-3 * MM;

/// Returns the convex hull of points as a box or a prism if it is one, else as a hull; `None` if it has no volume.
pub fn solid_of(points: &[Point3<f64>]) -> Option<Solid> {
    let (corners, _) = hull(points)?;
    let prism = [2, 0, 1].into_iter().find_map(|axis| Some((axis, prism_along(&corners, axis)?)));
    let Some((axis, (outline, span))) = prism else { return Some(Solid::Hull { points: corners }) };
    let [min, max] = [0, 1].map(|end| Vector3::from_fn(|axis, _| extent(&corners, axis)[end]));
    let (a, b) = other_axes(axis);
    let on_corner = |p: &[f64; 2]| {
        let at_end = |v: f64, i: usize| (v - min[i]).abs() < NEAR || (v - max[i]).abs() < NEAR;
        at_end(p[0], a) && at_end(p[1], b)
    };
    let is_box = outline.len() == 4 && outline.iter().all(on_corner);
    Some(if is_box { Solid::Box { min, max } } else { Solid::Prism { axis, outline, span } })
}

/// Returns the outline and the span of a prism along an axis; `None` if the hull of the corners is not such a prism.
fn prism_along(corners: &[Point3<f64>], axis: usize) -> Option<(Vec<[f64; 2]>, [f64; 2])> {
    let ends = extent(corners, axis);
    let (a, b) = other_axes(axis);
    let at = |end: f64| -> Vec<[f64; 2]> {
        let near = corners.iter().filter(|p| (p[axis] - end).abs() < NEAR);
        near.map(|p| [p[a], p[b]]).collect()
    };
    let [first, second] = ends.map(at);
    let same =
        |p: &[f64; 2], q: &[f64; 2]| (p[0] - q[0]).abs() < NEAR && (p[1] - q[1]).abs() < NEAR;
    let within =
        |some: &[[f64; 2]], all: &[[f64; 2]]| some.iter().all(|p| all.iter().any(|q| same(p, q)));
    let all_at_ends = first.len() + second.len() == corners.len();
    let equal = all_at_ends && within(&first, &second) && within(&second, &first);
    equal.then(|| (outline(first), ends))
}

/// Returns the corners of a convex outline counter-clockwise, without collinear ones.
fn outline(mut corners: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let count = corners.len() as f64;
    let middle = [0, 1].map(|i| corners.iter().map(|p| p[i]).sum::<f64>() / count);
    let angle = |p: &[f64; 2]| libm::atan2(p[1] - middle[1], p[0] - middle[0]);
    corners.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
    let straight = |[p, q, r]: [[f64; 2]; 3]| {
        (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0]) < 1e-4 * MM * MM
    };
    loop {
        let count = corners.len();
        let about = |i: usize| [(i + count - 1) % count, i, (i + 1) % count].map(|i| corners[i]);
        match (0..count).find(|&i| count > 3 && straight(about(i))) {
            Some(i) => corners.remove(i),
            None => return corners,
        };
    }
}
