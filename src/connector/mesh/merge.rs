//! Convex pieces put together where they are one convex solid, and named by their shape.

use super::cut::Piece;
use crate::connector::body::span;
use input::units::MM;
use insertion::task::{Solid, geometry};
use nalgebra::{Point3, Vector3};

/// Two volumes that differ by less than this share are one.
const ALIKE: f64 = 1e-6;
/// Coordinates that are nearer than this are one, m.
const NEAR: f64 = 1e-3 * MM;

/// A convex piece with its volume.
struct Convex {
    corners: Vec<Point3<f64>>,
    volume: f64,
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Convex {
    fn new(piece: &[Point3<f64>]) -> Option<Self> {
        let (corners, faces) = geometry::hull(piece)?;
        let volume = geometry::surface_moments(&corners, &faces).0;
        let low = Vector3::from_fn(|axis, _| span(corners.iter().map(|p| p[axis]))[0]);
        let high = Vector3::from_fn(|axis, _| span(corners.iter().map(|p| p[axis]))[1]);
        Some(Convex { corners, volume, low, high })
    }

    fn touches(&self, other: &Convex) -> bool {
        (0..3).all(|axis| {
            self.low[axis] < other.high[axis] + NEAR && other.low[axis] < self.high[axis] + NEAR
        })
    }

    /// The two as one, if nothing is added by that.
    fn with(&self, other: &Convex) -> Option<Convex> {
        let corners: Vec<_> = self.corners.iter().chain(&other.corners).copied().collect();
        let both = Convex::new(&corners)?;
        let sum = self.volume + other.volume;
        ((both.volume - sum).abs() < ALIKE * sum).then_some(both)
    }
}

/// As few solids as the pieces can be put together to.
pub fn solids(pieces: &[Piece]) -> Vec<Solid> {
    let mut convex: Vec<_> = pieces.iter().filter_map(|piece| Convex::new(piece)).collect();
    loop {
        let before = convex.len();
        let mut i = 0;
        while i < convex.len() {
            let mut j = i + 1;
            while j < convex.len() {
                let pair = convex[i].touches(&convex[j]).then(|| convex[i].with(&convex[j]));
                match pair.flatten() {
                    Some(both) => {
                        convex.swap_remove(j);
                        convex[i] = both;
                    }
                    None => j += 1,
                }
            }
            i += 1;
        }
        if convex.len() == before {
            break;
        }
    }
    // From the lowest up, as hand-written files have them.
    convex.sort_by(|a, b| {
        let key = |c: &Convex| [c.low.z, c.low.y, c.low.x];
        key(a)
            .iter()
            .zip(key(b))
            .map(|(a, b)| a.total_cmp(&b))
            .find(|o| o.is_ne())
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    convex.iter().map(solid).collect()
}

fn solid(convex: &Convex) -> Solid {
    for axis in [2, 0, 1] {
        let Some((outline, span)) = extruded(convex, axis) else { continue };
        let [low, high] = [convex.low, convex.high];
        let on_corner = |p: &[f64; 2]| {
            let (a, b) = others(axis);
            [(p[0], a), (p[1], b)]
                .iter()
                .all(|&(v, i)| (v - low[i]).abs() < NEAR || (v - high[i]).abs() < NEAR)
        };
        if outline.len() == 4 && outline.iter().all(on_corner) {
            return Solid::Box { min: low, max: high };
        }
        return Solid::Prism { axis, outline, span };
    }
    Solid::Hull { points: convex.corners.clone() }
}

fn others(axis: usize) -> (usize, usize) {
    match axis {
        0 => (1, 2),
        1 => (0, 2),
        _ => (0, 1),
    }
}

/// Outline and span, if the solid is an outline extruded along this axis.
fn extruded(convex: &Convex, axis: usize) -> Option<(Vec<[f64; 2]>, [f64; 2])> {
    let ends = [convex.low[axis], convex.high[axis]];
    let (a, b) = others(axis);
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

/// The corners in their order about the middle, without those on a straight line.
fn outline(mut corners: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let count = corners.len() as f64;
    let middle = [0, 1].map(|i| corners.iter().map(|p| p[i]).sum::<f64>() / count);
    let angle = |p: &[f64; 2]| libm::atan2(p[1] - middle[1], p[0] - middle[0]);
    corners.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
    loop {
        let n = corners.len();
        let straight = |i: usize| {
            let [p, q, r] = [(i + n - 1) % n, i, (i + 1) % n].map(|i| corners[i]);
            let turn = (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0]);
            turn < 1e-4 * MM * MM
        };
        match (0..n).find(|&i| n > 3 && straight(i)) {
            Some(i) => corners.remove(i),
            None => return corners,
        };
    }
}
