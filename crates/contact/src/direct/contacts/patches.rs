//! Flat patches: the contact points of two bodies that lie in one plane, whichever shapes they belong to.
//! Each patch is reduced to its extreme points, so that stiffness and friction do not depend on the
//! number of facets: every corner of a patch has the stiffness of a point, a face that of four points, an edge
//! that of two.

use super::Touch;
use nalgebra::{Matrix3, Vector3};

/// Largest number of points of a patch.
pub(super) const POINTS: usize = 4;
/// Cosine of the largest angle between the normals of a patch, 2.5 degrees.
const ALIKE: f64 = 0.999;
/// Largest distance of a point from the plane of a patch, as a share of that along it.
const TILT: f64 = 0.05;
/// Largest error of a gap that is linear over the patch, m: as much as contacts sink.
const FLAT: f64 = 5e-6;
/// Gaps that differ by less are equal, m.
const EQUAL: f64 = 2e-6;
/// Distance of points from one another, or from the line between two others, below which they are merged, m: a
/// rounded edge and the adjacent face touch a wall side by side.
pub(super) const NARROW: f64 = 0.1e-3;

/// Joins the manifolds of each patch and reduces the patch to its extreme points.
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
    let mut patches: Vec<Patch> = Vec::new();
    for manifold in manifolds {
        let normal = manifold[0].normal;
        let near = (0..normals.len()).filter(|&i| normals[i].dot(&normal) > ALIKE);
        if !{ near }.any(|i| patches[i].take(manifold)) {
            normals.push(normal);
            patches.push(Patch::new(manifold));
        }
    }
    touches.clear();
    for Patch { touches: patch, .. } in patches {
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

/// Patch under construction: its touches, sums over them, and a linear fit of their gaps.
struct Patch {
    touches: Vec<Touch>,
    sums: Sums,
    line: Line,
}

/// Sums over touches for a linear fit of the gap; positions are relative to the first touch.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    place: Vector3<f64>,
    gap: f64,
    squares: Matrix3<f64>,
    product: Vector3<f64>,
    /// Largest distance from the first touch.
    reach: f64,
}

/// Linear fit of the gap over the position relative to the first touch, and its largest error.
#[derive(Clone, Copy)]
struct Line {
    level: f64,
    slope: Vector3<f64>,
    off: f64,
}

impl Sums {
    fn with(mut self, first: &Touch, touches: &[Touch]) -> Self {
        self.count += touches.len() as f64;
        for touch in touches {
            let at = touch.point - first.point;
            self.place += at;
            self.gap += touch.gap;
            self.squares += at * at.transpose();
            self.product += at * touch.gap;
            self.reach = self.reach.max(at.norm());
        }
        self
    }

    fn line(&self) -> Option<Line> {
        let (place, mean) = (self.place / self.count, self.gap / self.count);
        let spread = self.squares - place * self.place.transpose();
        // No slope across a line or off the plane.
        let least = Matrix3::from_diagonal_element(1e-6 * spread.trace() + NARROW * FLAT);
        let slope = (spread + least).try_inverse()? * (self.product - place * self.gap);
        Some(Line { level: mean - slope.dot(&place), slope, off: f64::INFINITY })
    }
}

impl Line {
    /// Returns its largest error for these touches.
    fn off(&self, first: &Touch, touches: &[Touch]) -> f64 {
        let off = |touch: &Touch| {
            (touch.gap - self.level - self.slope.dot(&(touch.point - first.point))).abs()
        };
        touches.iter().map(off).fold(0.0, f64::max)
    }
}

impl Patch {
    fn new(touches: &[Touch]) -> Self {
        let line = Line { level: 0.0, slope: Vector3::zeros(), off: f64::INFINITY };
        let sums = Sums::default().with(&touches[0], touches);
        Patch { touches: touches.to_vec(), sums, line }
    }

    /// Adds a manifold if it lies in the plane of the patch and the gap is linear over both; returns whether it was added.
    fn take(&mut self, manifold: &[Touch]) -> bool {
        let first = &self.touches[0];
        let coplanar = |touch: &Touch| {
            let way = touch.point - first.point;
            way.dot(&first.normal).abs() < FLAT + TILT * way.norm()
        };
        if !alike(first, &manifold[0]) || !manifold.iter().all(coplanar) {
            return false;
        }
        let sums = self.sums.with(first, manifold);
        let Some(line) = sums.line() else { return false };
        let new = line.off(first, manifold);
        if new >= FLAT {
            return false;
        }
        // A bound first: with hundreds of touches, the errors of all for each manifold take half the time of a trial.
        let moved = (line.level - self.line.level).abs()
            + (line.slope - self.line.slope).norm() * self.sums.reach;
        let bound = self.line.off + moved;
        let old = if bound < FLAT { bound } else { line.off(first, &self.touches) };
        if old >= FLAT {
            return false;
        }
        self.touches.extend(manifold);
        self.sums = sums;
        self.line = Line { off: new.max(old), ..line };
        true
    }
}

/// Returns at most four points that span a patch, the deepest among them.
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
