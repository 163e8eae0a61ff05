//! Convex solids of points: boxes, prisms, hulls.

use crate::body::extent;
use input::units::MM;
use insertion::task::{Solid, geometry};
use nalgebra::{Point3, Vector3};

/// Largest difference of equal coordinates, m.
const NEAR: f64 = 1e-3 * MM;

/// Convex hull with its bounds, m.
struct Convex {
    corners: Vec<Point3<f64>>,
    low: Vector3<f64>,
    high: Vector3<f64>,
}

/// Returns the hull of points as a box, a prism or a hull; `None` without volume.
pub fn solid_of(points: &[Point3<f64>]) -> Option<Solid> {
    let (corners, _) = geometry::hull(points)?;
    let [low, high] = [0, 1].map(|end| Vector3::from_fn(|axis, _| extent(&corners, axis)[end]));
    Some(solid(&Convex { corners, low, high }))
}

fn solid(convex: &Convex) -> Solid {
    let (min, max) = (convex.low, convex.high);
    let prism = [2, 0, 1].into_iter().find_map(|axis| Some((axis, extruded(convex, axis)?)));
    let Some((axis, (outline, span))) = prism else {
        return Solid::Hull { points: convex.corners.clone() };
    };
    let on_corner = |p: &[f64; 2]| {
        let at_end = |v: f64, i: usize| (v - min[i]).abs() < NEAR || (v - max[i]).abs() < NEAR;
        p.iter().zip(OTHERS[axis]).all(|(&v, i)| at_end(v, i))
    };
    match outline.len() == 4 && outline.iter().all(on_corner) {
        true => Solid::Box { min, max },
        false => Solid::Prism { axis, outline, span },
    }
}

/// The two other axes of each axis.
const OTHERS: [[usize; 2]; 3] = [[1, 2], [0, 2], [0, 1]];

/// Outline and span, if the solid is an outline extruded along this axis.
fn extruded(convex: &Convex, axis: usize) -> Option<(Vec<[f64; 2]>, [f64; 2])> {
    let ends = [convex.low[axis], convex.high[axis]];
    let [a, b] = OTHERS[axis];
    let at = |end: f64| -> Vec<[f64; 2]> {
        let near = convex.corners.iter().filter(|p| (p[axis] - end).abs() < NEAR);
        near.map(|p| [p[a], p[b]]).collect()
    };
    let [first, second] = ends.map(at);
    let same =
        |p: &[f64; 2], q: &[f64; 2]| (p[0] - q[0]).abs() < NEAR && (p[1] - q[1]).abs() < NEAR;
    let within =
        |some: &[[f64; 2]], all: &[[f64; 2]]| some.iter().all(|p| all.iter().any(|q| same(p, q)));
    let all_at_ends = first.len() + second.len() == convex.corners.len();
    if !(all_at_ends && within(&first, &second) && within(&second, &first)) {
        return None;
    }
    Some((outline(first), ends))
}

/// Corners in their order about the middle, without those on a straight line.
fn outline(mut corners: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let count = corners.len() as f64;
    let middle = [0, 1].map(|i| corners.iter().map(|p| p[i]).sum::<f64>() / count);
    let angle = |p: &[f64; 2]| libm::atan2(p[1] - middle[1], p[0] - middle[0]);
    corners.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
    without(corners, 3, |[p, q, r]| {
        (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0]) < 1e-4 * MM * MM
    })
}

/// Returns a closed line of at least `least` corners, without those straight with their neighbours.
fn without<T: Copy>(mut line: Vec<T>, least: usize, straight: impl Fn(&[T; 3]) -> bool) -> Vec<T> {
    loop {
        let count = line.len();
        let three = |i: usize| [(i + count - 1) % count, i, (i + 1) % count].map(|i| line[i]);
        match (0..count).find(|&i| count > least && straight(&three(i))) {
            Some(i) => line.remove(i),
            None => return line,
        };
    }
}
