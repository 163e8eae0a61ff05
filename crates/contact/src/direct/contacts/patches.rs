//! Flat patches: the contact points of two bodies that share a plane, whatever shapes found them.
//! Each is reduced to its extreme points, so that stiffness and friction do not depend on the
//! number of facets: every corner of a patch bears with the stiffness of a point, a face with that
//! of four, an edge of two.

use super::Touch;
use nalgebra::{Matrix3, Vector3};

/// Most points of a patch.
pub(super) const POINTS: usize = 4;
/// Cosine of the largest angle between the normals of a patch, 2.5 degrees.
const ALIKE: f64 = 0.999;
/// Largest distance of a point from the plane of a patch, as a share of that along it.
const TILT: f64 = 0.05;
/// Largest error of a gap that is linear over the patch, m: as much as contacts sink.
const FLAT: f64 = 5e-6;
/// Gaps that differ by less are equal, m.
const EQUAL: f64 = 2e-6;
/// Points nearer to one another, or to the line between two others, are one, m: a rounded edge and
/// the face that ends at it touch a wall side by side.
pub(super) const NARROW: f64 = 0.1e-3;

/// Joins the manifolds of each patch and keeps their extreme points.
pub(super) fn join(touches: &mut Vec<Touch>) {
    let manifolds: Vec<_> = touches.chunk_by(|a, b| a.geoms == b.geoms).collect();
    // Close together in memory: most patches differ in their normals.
    let mut normals: Vec<Vector3<f64>> =
        manifolds.iter().map(|touches| touches[0].normal).collect();
    let alike = |i: usize, j: usize| {
        normals[i].dot(&normals[j]) > ALIKE && alike(&manifolds[i][0], &manifolds[j][0])
    };
    let count = manifolds.len();
    if !(0..count).any(|i| (i + 1..count).any(|j| alike(i, j))) {
        return;
    }
    normals.clear();
    let mut patches: Vec<Vec<Touch>> = Vec::new();
    for manifold in manifolds {
        let normal = manifold[0].normal;
        let near = (0..normals.len()).filter(|&i| normals[i].dot(&normal) > ALIKE);
        match { near }.find(|&i| share_plane(&patches[i], manifold)) {
            Some(i) => patches[i].extend(manifold),
            None => {
                normals.push(normal);
                patches.push(manifold.to_vec());
            }
        }
    }
    touches.clear();
    for patch in patches {
        let Touch { geoms, normal, .. } = patch[0];
        if patch.iter().all(|touch| touch.geoms == geoms) {
            touches.extend(patch);
            continue;
        }
        let (place, gap) = (|i: usize| patch[i].point.coords, |i: usize| patch[i].gap);
        let chosen = extremes(patch.len(), place, gap, &normal).into_iter();
        touches.extend(chosen.map(|i| Touch { geoms, ..patch[i] }));
    }
}

/// Returns whether two touches may belong to one patch.
fn alike(a: &Touch, b: &Touch) -> bool {
    a.pair == b.pair && a.normal.dot(&b.normal) > ALIKE && a.friction == b.friction
}

/// Returns whether a manifold lies in the plane of a patch, with a gap that is linear over both.
fn share_plane(patch: &[Touch], manifold: &[Touch]) -> bool {
    let first = &patch[0];
    let coplanar = |touch: &Touch| {
        let way = touch.point - first.point;
        way.dot(&first.normal).abs() < FLAT + TILT * way.norm()
    };
    if !alike(first, &manifold[0]) || !manifold.iter().all(coplanar) {
        return false;
    }
    let points =
        || patch.iter().chain(manifold).map(|touch| (touch.point - first.point, touch.gap));
    let count = (patch.len() + manifold.len()) as f64;
    let place = points().map(|(place, _)| place).sum::<Vector3<f64>>() / count;
    let mean = points().map(|(_, gap)| gap).sum::<f64>() / count;
    let centred = || points().map(|(at, gap)| (at - place, gap - mean));
    let spread: Matrix3<f64> = centred().map(|(at, _)| at * at.transpose()).sum();
    let product: Vector3<f64> = centred().map(|(at, gap)| at * gap).sum();
    // No slope across a line or off the plane.
    let least = Matrix3::from_diagonal_element(1e-6 * spread.trace() + NARROW * FLAT);
    let Some(inverse) = (spread + least).try_inverse() else { return false };
    let slope = inverse * product;
    centred().all(|(at, gap)| (gap - slope.dot(&at)).abs() < FLAT)
}

/// Returns at most four points of a patch, the deepest among them, that span it.
pub(super) fn extremes(
    count: usize,
    place: impl Fn(usize) -> Vector3<f64>,
    gap: impl Fn(usize) -> f64,
    axis: &Vector3<f64>,
) -> Vec<usize> {
    let middle = (0..count).map(&place).sum::<Vector3<f64>>() / count as f64;
    let depth = (0..count).map(&gap).fold(f64::INFINITY, f64::min) + EQUAL;
    let outward = |i: usize| (place(i) - middle).norm_squared();
    let deepest = best(count, |i| if gap(i) <= depth { outward(i) } else { -1.0 });
    let far = best(count, |i| (place(i) - place(deepest)).norm_squared());
    let line = place(far) - place(deepest);
    let length = line.norm();
    if length < NARROW {
        return vec![deepest];
    }
    let side = |i: usize| line.cross(&(place(i) - place(deepest))).dot(axis) / length;
    let sides = [best(count, side), best(count, |i| -side(i))];
    let wide = sides.into_iter().filter(|&i| side(i).abs() >= NARROW);
    let mut chosen: Vec<_> = [deepest, far].into_iter().chain(wide).collect();
    chosen.sort_unstable();
    chosen
}

/// Returns the first index below `count` with the largest value.
fn best(count: usize, value: impl Fn(usize) -> f64) -> usize {
    (1..count).fold(0, |best, i| if value(i) > value(best) { i } else { best })
}
