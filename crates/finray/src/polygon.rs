//! Polygons in the plane: area, self-intersection, and clipping by a half plane.

use nalgebra::{Point2, Vector2};

/// Closed polygon by its corners, the first not repeated at the end. Solid material is on the left: holes are
/// clockwise.
pub type Ring = Vec<Point2<f64>>;

/// Returns the edges of a ring, each by its two ends.
pub fn edges(ring: &[Point2<f64>]) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> {
    ring.iter().copied().zip(ring.iter().copied().cycle().skip(1))
}

/// Returns the area of a ring, negative if it is clockwise.
pub fn area(ring: &[Point2<f64>]) -> f64 {
    edges(ring).map(|(a, b)| a.coords.perp(&b.coords)).sum::<f64>() / 2.0
}

/// Returns the length around a ring.
pub fn perimeter(ring: &[Point2<f64>]) -> f64 {
    edges(ring).map(|(a, b)| (b - a).norm()).sum()
}

/// Returns whether two edges of a ring that are not neighbours meet.
pub fn crosses_itself(ring: &[Point2<f64>]) -> bool {
    let edges: Vec<_> = edges(ring).collect();
    let neighbours = |i: usize, j: usize| j == i + 1 || (i == 0 && j == edges.len() - 1);
    (0..edges.len()).any(|i| {
        (i + 1..edges.len()).any(|j| !neighbours(i, j) && segments_meet(edges[i], edges[j]))
    })
}

fn segments_meet(a: (Point2<f64>, Point2<f64>), b: (Point2<f64>, Point2<f64>)) -> bool {
    let apart = |(from, to): (Point2<f64>, Point2<f64>), p: Point2<f64>, q: Point2<f64>| {
        (to - from).perp(&(p - from)) * (to - from).perp(&(q - from)) > 0.0
    };
    !apart(a, b.0, b.1) && !apart(b, a.0, a.1)
}

/// Half plane of the points `p` with `normal . p >= offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// Unit vector into the half plane.
    pub normal: Vector2<f64>,
    /// Distance of its boundary from the origin along the normal.
    pub offset: f64,
}

impl HalfPlane {
    /// Returns the distance of a point from the boundary, positive inside.
    pub fn depth(&self, point: Point2<f64>) -> f64 {
        self.normal.dot(&point.coords) - self.offset
    }

    /// Returns the parts of a counter-clockwise ring in the half plane; a ring that is not convex can have several.
    pub fn cut(&self, ring: &[Point2<f64>]) -> Vec<Ring> {
        let inside = |p: &Point2<f64>| self.depth(*p) >= 0.0;
        let Some(start) = ring.iter().position(|p| !inside(p)) else { return vec![ring.to_vec()] };
        let mut turned = ring.to_vec();
        turned.rotate_left(start);
        let mut chains: Vec<Ring> = Vec::new();
        for (a, b) in edges(&turned) {
            let (before, after) = (inside(&a), inside(&b));
            if !before && after {
                chains.push(vec![self.crossing(a, b)]);
            }
            // The first corner is outside, so every inside part has begun with a crossing.
            if let Some(chain) = chains.last_mut().filter(|_| before || after) {
                chain.push(if after { b } else { self.crossing(a, b) });
            }
        }
        self.close(chains)
    }

    fn crossing(&self, a: Point2<f64>, b: Point2<f64>) -> Point2<f64> {
        let (at_a, at_b) = (self.depth(a), self.depth(b));
        a + (b - a) * (at_a / (at_a - at_b))
    }

    /// Joins chains into closed rings. Each chain runs from the point where the ring enters the half plane to the point
    /// where it leaves. Sorted along the boundary, these points are pairwise the ends of edges of the new rings.
    fn close(&self, chains: Vec<Ring>) -> Vec<Ring> {
        let along = Vector2::new(-self.normal.y, self.normal.x);
        // (coordinate along the boundary, chain, whether it is the end of the chain)
        let mut crossings: Vec<(f64, usize, bool)> = Vec::new();
        for (i, chain) in chains.iter().enumerate() {
            for (point, end) in [(chain.first(), false), (chain.last(), true)] {
                crossings.extend(point.map(|p| (along.dot(&p.coords), i, end)));
            }
        }
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut next = vec![None; chains.len()];
        for pair in crossings.chunks_exact(2) {
            if let [(_, from, true), (_, to, false)] | [(_, to, false), (_, from, true)] = *pair {
                next[from] = Some(to);
            }
        }
        let joined = |ring: Vec<usize>| ring.iter().flat_map(|&i| &chains[i]).copied().collect();
        let rings = cycles(next).into_iter().map(joined);
        rings.filter(|ring: &Ring| ring.len() > 2).collect()
    }
}

/// Returns the cycles of a chain of indices, in which each index leads to the `next`.
pub(super) fn cycles(mut next: Vec<Option<usize>>) -> Vec<Vec<usize>> {
    let mut cycles = vec![Vec::new(); next.len()];
    for (start, cycle) in cycles.iter_mut().enumerate() {
        let mut at = start;
        while let Some(to) = next[at].take() {
            cycle.push(at);
            at = to;
        }
    }
    cycles.retain(|cycle| !cycle.is_empty());
    cycles
}

/// Returns the ring without corners that lie within `distance` of the previous one.
pub fn without_repeats(ring: &[Point2<f64>], distance: f64) -> Ring {
    let mut kept = ring.to_vec();
    kept.dedup_by(|p, before| (*p - *before).norm() <= distance);
    while kept.len() > 1 && (kept[0] - kept[kept.len() - 1]).norm() <= distance {
        kept.pop();
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[(f64, f64)]) -> Ring {
        points.iter().map(|&(x, y)| Point2::new(x, y)).collect()
    }

    #[test]
    fn a_bent_ring_is_cut_into_its_arms() {
        let u =
            ring(&[(0., 0.), (5., 0.), (5., 4.), (4., 4.), (4., 1.), (1., 1.), (1., 4.), (0., 4.)]);
        let above = HalfPlane { normal: Vector2::new(0.0, 1.0), offset: 2.0 };
        let below = HalfPlane { normal: Vector2::new(0.0, -1.0), offset: -2.0 };
        let arms = above.cut(&u);
        assert_eq!(arms.len(), 2);
        assert!(arms.iter().all(|arm| (area(arm) - 2.0).abs() < 1e-12));
        let foot = below.cut(&u);
        assert_eq!(foot.len(), 1);
        assert!((area(&foot[0]) + 4.0 - area(&u)).abs() < 1e-12);
    }

    #[test]
    fn a_cut_beside_a_ring_takes_all_or_nothing() {
        let square = ring(&[(0., 0.), (1., 0.), (1., 1.), (0., 1.)]);
        let right = |offset| HalfPlane { normal: Vector2::new(1.0, 0.0), offset };
        assert_eq!(right(-1.0).cut(&square), vec![square.clone()]);
        assert!(right(2.0).cut(&square).is_empty());
    }

    #[test]
    fn a_bow_tie_crosses_itself() {
        assert!(crosses_itself(&ring(&[(0., 0.), (1., 1.), (1., 0.), (0., 1.)])));
        assert!(!crosses_itself(&ring(&[(0., 0.), (1., 0.), (1., 1.), (0., 1.)])));
    }
}
