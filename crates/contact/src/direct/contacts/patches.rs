//! Contact patches: the contact points of two bodies that lie in one plane, whichever geoms they belong to. Each patch
//! is reduced to its extreme points, the corners, so that stiffness and friction do not depend on the number of facets:
//! a face has the stiffness of four contact points, an edge that of two.

use super::Touch;
use nalgebra::{Matrix3, Vector3};

/// Largest number of points of a patch.
pub(super) const MAX_POINTS: usize = 4;
/// Cosine of the largest angle between the normals of a patch: 2.6 degrees.
const MIN_COSINE: f64 = 0.999;
/// Largest distance of a point from the plane of a patch, divided by its distance from the patch's first point.
const MAX_SLOPE: f64 = 0.05;
/// Largest deviation of the gap from a linear function over the patch, m: the penetration of a contact point by default
/// under 2.75 N.
const MAX_ERROR: f64 = 5e-6;
/// Gaps that differ by less are equal, m.
const GAP_TOLERANCE: f64 = 2e-6;
/// Distance of points from one another, or of a point from the line through two others, below which they are merged, m:
/// a rounded edge and the face beside it touch a wall at neighbouring points.
pub(super) const MIN_SPACING: f64 = 0.1e-3;

/// Joins the manifolds (contact points of one geom pair) that form a patch, and reduces the patch to its extreme
/// points.
pub(super) fn join(touches: &mut Vec<Touch>) {
    let manifolds: Vec<_> = touches.chunk_by(|a, b| a.geoms == b.geoms).collect();
    // Contiguous in memory: most pairs are already excluded by their normals.
    let mut normals: Vec<Vector3<f64>> =
        manifolds.iter().map(|touches| touches[0].normal).collect();
    let alike = |i: usize, j: usize| {
        normals[i].dot(&normals[j]) > MIN_COSINE && alike(&manifolds[i][0], &manifolds[j][0])
    };
    let count = manifolds.len();
    if !(0..count).any(|i| (i + 1..count).any(|j| alike(i, j))) {
        return;
    }
    normals.clear();
    let mut patches: Vec<PatchBuilder> = Vec::new();
    for manifold in manifolds {
        let normal = manifold[0].normal;
        let near = (0..normals.len()).filter(|&i| normals[i].dot(&normal) > MIN_COSINE);
        if !{ near }.any(|i| patches[i].try_add(manifold)) {
            normals.push(normal);
            patches.push(PatchBuilder::new(manifold));
        }
    }
    touches.clear();
    for PatchBuilder { touches: patch, .. } in patches {
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
    a.pair == b.pair && a.normal.dot(&b.normal) > MIN_COSINE && a.friction == b.friction
}

/// Patch under construction: its touches, sums over them, and a linear fit of their gaps.
struct PatchBuilder {
    touches: Vec<Touch>,
    sums: Sums,
    fit: LinearFit,
}

/// Sums for a linear fit of the gap g, m, by the position p relative to the first touch, m: number of touches, p, g, p
/// p^T, p g.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    place: Vector3<f64>,
    gap: f64,
    squares: Matrix3<f64>,
    product: Vector3<f64>,
    /// Largest distance from the first touch, m.
    reach: f64,
}

/// Linear fit of the gap by the position relative to the first touch, and an upper bound of its error, m.
#[derive(Clone, Copy)]
struct LinearFit {
    intercept: f64,
    slope: Vector3<f64>,
    error: f64,
}

impl Sums {
    /// Returns the sums with these touches added.
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

    /// Returns the least-squares fit.
    fn fit(&self) -> Option<LinearFit> {
        let (place, mean) = (self.place / self.count, self.gap / self.count);
        let spread = self.squares - place * self.place.transpose();
        // Regularized: the slope is 0 in directions in which the touches do not extend.
        let least = Matrix3::from_diagonal_element(1e-6 * spread.trace() + MIN_SPACING * MAX_ERROR);
        let slope = (spread + least).try_inverse()? * (self.product - place * self.gap);
        Some(LinearFit { intercept: mean - slope.dot(&place), slope, error: f64::INFINITY })
    }
}

impl LinearFit {
    /// Returns the largest error of the fit at these touches, m.
    fn error_at(&self, first: &Touch, touches: &[Touch]) -> f64 {
        let error = |touch: &Touch| {
            (touch.gap - self.intercept - self.slope.dot(&(touch.point - first.point))).abs()
        };
        touches.iter().map(error).fold(0.0, f64::max)
    }
}

impl PatchBuilder {
    fn new(touches: &[Touch]) -> Self {
        let fit = LinearFit { intercept: 0.0, slope: Vector3::zeros(), error: f64::INFINITY };
        let sums = Sums::default().with(&touches[0], touches);
        PatchBuilder { touches: touches.to_vec(), sums, fit }
    }

    /// Adds a manifold if it lies in the plane of the patch and the gap is linear over both; returns whether it was
    /// added.
    fn try_add(&mut self, manifold: &[Touch]) -> bool {
        let first = &self.touches[0];
        let coplanar = |touch: &Touch| {
            let offset = touch.point - first.point;
            offset.dot(&first.normal).abs() < MAX_ERROR + MAX_SLOPE * offset.norm()
        };
        if !alike(first, &manifold[0]) || !manifold.iter().all(coplanar) {
            return false;
        }
        let sums = self.sums.with(first, manifold);
        let Some(fit) = sums.fit() else { return false };
        let new = fit.error_at(first, manifold);
        if new >= MAX_ERROR {
            return false;
        }
        // With hundreds of touches, all errors for each manifold would take half the computing time; the bound suffices
        // for most manifolds.
        let moved = (fit.intercept - self.fit.intercept).abs()
            + (fit.slope - self.fit.slope).norm() * self.sums.reach;
        let bound = self.fit.error + moved;
        let old = if bound < MAX_ERROR { bound } else { fit.error_at(first, &self.touches) };
        if old >= MAX_ERROR {
            return false;
        }
        self.touches.extend(manifold);
        self.sums = sums;
        self.fit = LinearFit { error: new.max(old), ..fit };
        true
    }
}

/// Returns the indices of at most four of `count` points that span a patch with the normal `axis`, the deepest among
/// them.
pub(super) fn extremes(
    count: usize,
    place: impl Fn(usize) -> Vector3<f64>,
    gap: impl Fn(usize) -> f64,
    axis: &Vector3<f64>,
) -> Vec<usize> {
    let middle = (0..count).map(&place).sum::<Vector3<f64>>() / count as f64;
    let depth = (0..count).map(&gap).fold(f64::INFINITY, f64::min) + GAP_TOLERANCE;
    let outward = |i: usize| (place(i) - middle).norm_squared();
    let deepest = argmax(count, |i| if gap(i) <= depth { outward(i) } else { -1.0 });
    let far = argmax(count, |i| (place(i) - place(deepest)).norm_squared());
    let line = place(far) - place(deepest);
    let length = line.norm();
    if length < MIN_SPACING {
        return vec![deepest];
    }
    let side = |i: usize| line.cross(&(place(i) - place(deepest))).dot(axis) / length;
    let sides = [argmax(count, side), argmax(count, |i| -side(i))];
    let wide = sides.into_iter().filter(|&i| side(i).abs() >= MIN_SPACING);
    let mut chosen: Vec<_> = [deepest, far].into_iter().chain(wide).collect();
    chosen.sort_unstable();
    chosen
}

/// Returns the first index below `count` with the largest value.
fn argmax(count: usize, value: impl Fn(usize) -> f64) -> usize {
    (1..count).fold(0, |best, i| if value(i) > value(best) { i } else { best })
}
