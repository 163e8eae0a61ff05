//! Plug or socket as a set of convex parts: overlaps, gaps, extents, clipping.

pub use ask_tell::statistics::span;
use contact::scene::Pose;
use contact::shapes;
use input::units::MM;
use insertion::Part;
use insertion::task::Plug;
use insertion::task::geometry::outline_by;
use nalgebra::{Point2, Point3, Vector3};
use parry::bounding_volume::{Aabb, BoundingVolume};
use parry::partitioning::{Bvh, BvhBuildStrategy};
use parry::query;
use parry::shape::SharedShape;
use rapier3d_f64::parry;
use std::borrow::Borrow;

/// Scale of lengths for parry, whose tolerances suit bodies of size 1: millimetres per metre.
const MILLIMETRES: f64 = 1.0 / MM;

/// Body of convex parts in its own frame.
pub struct ConvexBody<'a> {
    /// Parts, body frame, m.
    pub parts: &'a [Part],
    shapes: Vec<PlacedShape>,
    /// Tree of the bounding boxes of the parts, mm.
    tree: Bvh,
    /// Indices of the parts of the latch, which another body can push aside.
    latch: &'a [usize],
}

/// Overlap of a part of one body with a part of another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// Depth, m.
    pub depth: f64,
    /// Direction of the shortest separation, from the first body to the second.
    pub normal: Vector3<f64>,
    /// Index of each part in its body.
    pub parts: [usize; 2],
}

struct PlacedShape {
    shape: SharedShape,
    pose: Pose,
    /// Centre of the bounding sphere, body frame, m, and its radius.
    centre: Point3<f64>,
    radius: f64,
}

impl<'a> ConvexBody<'a> {
    pub fn new(parts: &'a [Part]) -> Self {
        let place = |part: &Part| {
            let geom = part.geom();
            let (shape, turn) = shapes::shared(&geom.shape, MILLIMETRES);
            let corners = part.solid.corners();
            let sum = corners.iter().map(|p| p.coords).sum::<Vector3<f64>>();
            let centre = Point3::from(sum / corners.len() as f64);
            let far = corners.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max);
            // A cylinder bulges beyond its 16 corners by 2 %.
            PlacedShape { shape, pose: geom.pose * turn, centre, radius: 1.02 * far }
        };
        let shapes: Vec<PlacedShape> = parts.iter().map(place).collect();
        let boxes: Vec<Aabb> = shapes.iter().map(|part| part.boxed(&Pose::identity())).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        ConvexBody { parts, shapes, tree, latch: &[] }
    }

    /// Creates the body of a plug with its latch.
    pub fn plug(plug: &'a Plug) -> Self {
        let latch = plug.latch.as_ref().map_or(&[][..], |latch| &latch.parts);
        ConvexBody { latch, ..ConvexBody::new(&plug.parts) }
    }

    /// Returns the deepest overlap with another body at the pose `own` in its frame; overlaps of the latch are ignored.
    pub fn overlap(&self, own: &Pose, other: &ConvexBody) -> Option<Overlap> {
        let stiff = |overlap: &Overlap| !self.latch.contains(&overlap.parts[0]);
        let overlaps = self.overlaps(own, other).filter(stiff);
        overlaps.max_by(|a, b| a.depth.total_cmp(&b.depth))
    }

    /// Returns all overlaps with another body at the pose `own` in its frame, in the order of the parts.
    pub fn overlaps(&self, own: &Pose, other: &ConvexBody) -> impl Iterator<Item = Overlap> {
        self.pairs_within(0.0, own, other).into_iter().filter_map(move |parts| {
            let [first, second] = [&self.shapes[parts[0]], &other.shapes[parts[1]]];
            let apart = (own * first.centre - second.centre).norm() > first.radius + second.radius;
            let contact = if apart { None } else { first.contact(own, second, 0.0) }?;
            let (depth, normal) = (-contact.dist * MM, Vector3::from(contact.normal1));
            (contact.dist < 0.0).then_some(Overlap { depth, normal, parts })
        })
    }

    /// Returns the smallest gap to another body at the pose `own` in its frame, m (0 for an overlap), and its place in
    /// that frame, among the gaps below `wide`, m, at places that `counts` accepts.
    pub fn gap(
        &self,
        own: &Pose,
        other: &ConvexBody,
        wide: f64,
        counts: impl Fn(&Point3<f64>) -> bool,
    ) -> Option<(f64, Point3<f64>)> {
        let gap = |[i, j]: [usize; 2]| {
            let found = self.shapes[i].contact(own, &other.shapes[j], wide * MILLIMETRES)?;
            let place = Point3::from(Vector3::from(found.point1) * MM);
            counts(&place).then_some((found.dist.max(0.0) * MM, place))
        };
        let gaps = self.pairs_within(wide, own, other).into_iter().filter_map(gap);
        gaps.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Returns the pairs of parts whose boxes are within a distance, m, of one another, in order.
    fn pairs_within(&self, distance: f64, own: &Pose, other: &ConvexBody) -> Vec<[usize; 2]> {
        let near = |(i, shape): (usize, &PlacedShape)| {
            let boxed = shape.boxed(own).loosened(distance * MILLIMETRES);
            let near = other.tree.intersect_aabb(&boxed).map(|j| [i, j as usize]);
            near.collect::<Vec<_>>()
        };
        let mut pairs: Vec<_> = self.shapes.iter().enumerate().flat_map(near).collect();
        pairs.sort_unstable();
        pairs
    }

    /// Returns the gap between two parts of this body, m; 0 if they touch.
    pub fn own_gap(&self, i: usize, j: usize) -> f64 {
        let [a, b] = [&self.shapes[i], &self.shapes[j]];
        let [at, to] = [a, b].map(|part| shapes::pose(&part.pose, MILLIMETRES));
        // parry supports all pairs of the shapes of a task.
        query::distance(&at, &*a.shape, &to, &*b.shape).map_or(0.0, |found| found.distance * MM)
    }

    /// Returns the index of the first part that contains a point.
    pub fn part_at(&self, point: &Point3<f64>) -> Option<usize> {
        let point = (point.coords * MILLIMETRES).into();
        let holds = |part: &PlacedShape| {
            part.shape.contains_point(&shapes::pose(&part.pose, MILLIMETRES), point)
        };
        self.shapes.iter().position(holds)
    }

    /// Returns the indices of the parts within a distance, m, of a point, in any order.
    pub fn near(&self, point: &Point3<f64>, within: f64) -> impl Iterator<Item = usize> {
        let (centre, reach) = ((point.coords * MILLIMETRES).into(), within * MILLIMETRES);
        let boxed = Aabb::from_half_extents(centre, Vector3::repeat(reach).into());
        let close = move |i: &usize| {
            let part = &self.shapes[*i];
            let pose = shapes::pose(&part.pose, MILLIMETRES);
            part.shape.distance_to_point(&pose, centre, true) <= reach
        };
        let boxes: Vec<u32> = self.tree.intersect_aabb(&boxed).collect();
        boxes.into_iter().map(|i| i as usize).filter(close)
    }

    /// Returns the parts that the fingers can press, all but the latch, with their indices.
    pub fn stiff(&self) -> impl Iterator<Item = (usize, &Part)> {
        self.parts.iter().enumerate().filter(|(i, _)| !self.latch.contains(i))
    }

    /// Returns the lowest corner of the body at a pose; `None` without parts.
    pub fn lowest(&self, at: &Pose) -> Option<Point3<f64>> {
        self.corners().map(|p| at * p).min_by(|a, b| a.z.total_cmp(&b.z))
    }

    pub fn corners(&self) -> impl Iterator<Item = Point3<f64>> + '_ {
        self.parts.iter().flat_map(|part| part.solid.corners())
    }

    /// Returns the lowest and the highest coordinate along an axis (0 x, 1 y, 2 z), m.
    pub fn extent(&self, axis: usize) -> [f64; 2] {
        extent(self.corners(), axis)
    }
}

impl PlacedShape {
    /// Returns the bounding box of the part for a pose of its body, mm.
    fn boxed(&self, at: &Pose) -> Aabb {
        let part = self.shape.compute_aabb(&shapes::pose(&self.pose, MILLIMETRES));
        part.transform_by(&shapes::pose(at, MILLIMETRES))
    }

    /// Returns the contact with a part of another body within a distance, mm, at the pose `own` in the frame of that
    /// body.
    fn contact(&self, own: &Pose, other: &Self, within: f64) -> Option<query::Contact> {
        let [here, there] = [own * self.pose, other.pose].map(|at| shapes::pose(&at, MILLIMETRES));
        query::contact(&here, &*self.shape, &there, &*other.shape, within).ok().flatten()
    }
}

/// Returns the lowest and the highest coordinate of points along an axis (0 x, 1 y, 2 z); see [`span`].
pub fn extent<P: Borrow<Point3<f64>>>(
    points: impl IntoIterator<Item = P>,
    axis: usize,
) -> [f64; 2] {
    span(points.into_iter().map(|p| p.borrow()[axis]))
}

pub fn longest_side(points: &[Point3<f64>]) -> f64 {
    (0..3).map(|axis| width(extent(points, axis))).fold(0.0, f64::max)
}

pub fn width([low, high]: [f64; 2]) -> f64 {
    high - low
}

/// Returns the corners of a convex part clipped by two planes perpendicular to an axis: the corners between the planes,
/// and the points where a line from an inner corner to an outer one crosses a plane.
pub fn clipped(points: &[Point3<f64>], axis: usize, [from, to]: [f64; 2]) -> Vec<Point3<f64>> {
    let side = |points: &[Point3<f64>], plane: f64, sign: f64| {
        let (beyond, mut kept): (Vec<_>, Vec<_>) =
            points.iter().copied().partition(|p| sign * (p[axis] - plane) > 0.0);
        let crossing = |p: &Point3<f64>, q: &Point3<f64>| {
            p + (q - p) * ((plane - p[axis]) / (q[axis] - p[axis]))
        };
        let crossings =
            kept.iter().flat_map(|p| beyond.iter().map(move |q| crossing(p, q))).collect();
        // Corners inside the outline are dropped, so that repeated clipping does not multiply them.
        kept.extend(outline_by(crossings, |p| Point2::new(p[(axis + 1) % 3], p[(axis + 2) % 3])));
        kept
    };
    side(&side(points, to, 1.0), from, -1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use insertion::task::Solid;

    #[test]
    fn a_wedge_is_clipped_where_its_slope_is_cut() {
        // Width in x grows from 0 to 10 over a height of 10.
        let wedge = Solid::Prism {
            axis: 1,
            outline: vec![[0.0, 0.0], [0.01, 0.01], [0.0, 0.01]],
            span: [0.0, 0.01],
        };
        let [low, high] = extent(clipped(&wedge.corners(), 2, [0.0, 0.004]), 0);
        assert!(low.abs() < 1e-12 && (high - 0.004).abs() < 1e-12, "{low} {high}");
    }

    /// Four cuts of a body of many corners leave those of its outline.
    #[test]
    fn clipping_again_and_again_does_not_multiply_corners() {
        let ring = (0..64).map(|i| f64::from(i) * std::f64::consts::TAU / 64.0);
        let ends = ring.flat_map(|a| {
            [-5.0, 5.0].map(|z| Point3::new(9.0 * libm::cos(a), 9.0 * libm::sin(a), z))
        });
        let mut body: Vec<_> = ends.collect();
        for axis in [2, 0, 1, 0] {
            body = clipped(&body, axis, [-4.0, 3.0]);
            let [low, high] = extent(&body, axis);
            assert!((low + 4.0).abs().max((high - 3.0).abs()) < 1e-12, "{axis}: {low} {high}");
        }
        // A box of 7 mm, each of whose corners is there at least once.
        assert!((8..64).contains(&body.len()), "{} corners", body.len());
    }
}
