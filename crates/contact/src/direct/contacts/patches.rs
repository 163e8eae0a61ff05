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
const NARROW: f64 = 0.1e-3;

/// Joins the manifolds of each patch and keeps their extreme points.
pub(super) fn join(touches: &mut Vec<Touch>) {
    let manifolds: Vec<_> = touches.chunk_by(|a, b| a.geoms == b.geoms).collect();
    let alike = |(i, a): (usize, &&[Touch])| manifolds[i + 1..].iter().any(|b| alike(&a[0], &b[0]));
    if !manifolds.iter().enumerate().any(alike) {
        return;
    }
    let mut patches: Vec<Patch> = Vec::new();
    for manifold in manifolds {
        match patches.iter_mut().find_map(|patch| Some((patch.with(manifold)?, patch))) {
            Some((gaps, patch)) => patch.add(manifold, gaps),
            None => patches.push(Patch::new(manifold)),
        }
    }
    touches.clear();
    patches.iter().for_each(|patch| patch.report(touches));
}

/// Returns whether two touches may belong to one patch.
fn alike(a: &Touch, b: &Touch) -> bool {
    a.pair == b.pair && a.normal.dot(&b.normal) > ALIKE && a.friction == b.friction
}

/// Patch in the making.
struct Patch {
    touches: Vec<Touch>,
    gaps: Gaps,
    /// Number of manifolds.
    parts: usize,
}

impl Patch {
    fn new(manifold: &[Touch]) -> Self {
        let mut patch = Patch { touches: Vec::new(), gaps: Gaps::default(), parts: 0 };
        let gaps = patch.gaps.with(manifold, &manifold[0]);
        patch.add(manifold, gaps);
        patch
    }

    /// Returns the gaps of the patch with a manifold; `None` if they share no plane.
    fn with(&self, manifold: &[Touch]) -> Option<Gaps> {
        let first = &self.touches[0];
        let coplanar = |touch: &Touch| {
            let way = touch.point - first.point;
            way.dot(&first.normal).abs() < FLAT + TILT * way.norm()
        };
        if !alike(first, &manifold[0]) || !manifold.iter().all(coplanar) {
            return None;
        }
        let gaps = self.gaps.with(manifold, first);
        let (mean, slope) = gaps.fit()?;
        let off = |touch: &Touch| touch.gap - mean - slope.dot(&(touch.point - first.point));
        let (own, other) = (self.touches.iter().rev().take(POINTS), manifold.iter());
        own.chain(other).all(|touch| off(touch).abs() < FLAT).then_some(gaps)
    }

    fn add(&mut self, manifold: &[Touch], gaps: Gaps) {
        let geoms = self.touches.first().unwrap_or(&manifold[0]).geoms;
        self.touches.extend(manifold.iter().map(|touch| Touch { geoms, ..*touch }));
        self.gaps = gaps;
        self.parts += 1;
    }

    fn report(&self, found: &mut Vec<Touch>) {
        if self.parts == 1 {
            return found.extend(&self.touches);
        }
        let place = |i: usize| self.touches[i].point.coords;
        let gap = |i: usize| self.touches[i].gap;
        let chosen = extremes(self.touches.len(), place, gap, &self.touches[0].normal);
        found.extend(chosen.into_iter().map(|i| self.touches[i]));
    }
}

/// Sums over the points of a patch for a linear fit of the gap, about its first point.
#[derive(Clone, Copy, Default)]
struct Gaps {
    count: f64,
    place: Vector3<f64>,
    square: Matrix3<f64>,
    gap: f64,
    product: Vector3<f64>,
}

impl Gaps {
    fn with(mut self, manifold: &[Touch], first: &Touch) -> Self {
        for touch in manifold {
            let place = touch.point - first.point;
            self.count += 1.0;
            self.place += place;
            self.square += place * place.transpose();
            self.gap += touch.gap;
            self.product += place * touch.gap;
        }
        self
    }

    /// Returns the gap at the first point and its slope, by least squares.
    fn fit(&self) -> Option<(f64, Vector3<f64>)> {
        let spread = self.square - self.place * self.place.transpose() / self.count;
        // No slope across a line or off the plane.
        let least = 1e-6 * spread.trace() + NARROW * FLAT;
        let slope = (spread + Matrix3::from_diagonal_element(least)).try_inverse()?
            * (self.product - self.place * (self.gap / self.count));
        Some(((self.gap - slope.dot(&self.place)) / self.count, slope))
    }
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
