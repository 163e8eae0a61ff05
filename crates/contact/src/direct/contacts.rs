//! Collision detection: the points at which two bodies of a scene's contact pairs touch or are about to touch. While
//! two geoms hardly move relative to one another, their contact points are reused and only the gaps are updated.

mod lines;
mod near;
mod patches;
#[cfg(test)]
mod tests;

use super::body::MovingBody;
use crate::scene::{ContactPair, Friction, Geom, GeomPair, Pose, Scene, Shape};
use crate::shapes;
use nalgebra::{Matrix3, Point3, Vector3};
use near::{NearList, tree};
use parry::bounding_volume::{Aabb, BoundingVolume};
use parry::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry::shape::{Cuboid, SharedShape, SupportMap};
use rapier3d_f64::parry;
use std::sync::Arc;

/// Millimetres in a metre. parry computes in mm: some of its tolerances are absolute and made for parts of about 1 unit
/// (in metres it misses the contact of two edges of 1 mm that cross at less than a degree).
const MILLIMETRES: f64 = 1e3;
/// Distance in front of a surface at which a point in a neighbouring geom shows that the surface is covered, m.
const COVER_DISTANCE: f64 = 20e-6;
/// Tolerance of that test, m: less than any gap between parts.
const COVER_TOLERANCE: f64 = 2e-6;
/// Relative displacement of two geoms up to which their contact points are reused, m: a twentieth of the default
/// prediction distance.
const REUSE_DISTANCE: f64 = 10e-6;
/// Relative displacement, divided by the radius, up to which the contact points of round geoms are reused: the rotation
/// of the normal, rad.
const REUSE_ANGLE: f64 = 2e-3;

/// Number of geom pairs of two bodies above which only contacts whose gap may close within a step are predicted:
/// an imported surface has hundreds of facets within the prediction distance, and all would be tested in each step.
const MANY_PAIRS: usize = 2_000;
/// Prediction distance of such a body pair at rest, m; the largest relative displacement in a step is added to it.
const NEAR: f64 = 20e-6;

/// Contact point of two bodies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    /// Index of the body pair in the scene's contacts.
    pub pair: usize,
    /// Number of the geom pair; once joined to a patch, that of the first geom pair of the patch, which identifies it.
    /// The points of a patch are consecutive.
    pub geoms: usize,
    /// Position midway between the two surfaces, world, m.
    pub point: Point3<f64>,
    /// Unit normal from the first body to the second, world.
    pub normal: Vector3<f64>,
    /// Signed distance, m; negative if they overlap.
    pub gap: f64,
    /// Friction of the two surfaces.
    pub friction: Friction,
}

/// Geom with its parry shape and bounding volumes.
#[derive(Clone)]
struct Solid {
    body: usize,
    friction: Option<f64>,
    shape: SharedShape,
    /// Core and radius of a round geom ([`Shape::RoundBox`]), mm.
    round: Option<(Cuboid, f64)>,
    /// Outward normals of the faces of a hull, and distances of their planes from the origin, mm.
    faces: Vec<(Vector3<f64>, f64)>,
    /// Pose of parry's frame of the shape in the body frame.
    pose: Pose,
    /// Enclosing box: pose of its frame in the body frame, and half extents, m.
    frame: Pose,
    half: Vector3<f64>,
    /// Bounding box along the world's axes, m.
    aabb: Aabb,
    /// Pose of the body for which `aabb`, `axes` and `centre` were computed.
    enclosed_at: Option<Pose>,
    /// Axes and centre of the enclosing box in the world, m.
    axes: Matrix3<f64>,
    centre: Vector3<f64>,
    /// Upper bound of the distance of the shape's points from the origin of its frame, m.
    reach: f64,
    /// Other geoms of the same body that may cover a part of this one.
    neighbours: Arc<[Neighbour]>,
}

/// Neighbouring geom of the same body; the boxes of all neighbours are contiguous in memory.
struct Neighbour {
    solid: usize,
    /// Box that encloses the geom and all points that it may cover, body frame, m.
    aabb: Aabb,
}

/// Geom pair with its contact points, which are reused while it hardly moves.
#[derive(Clone)]
struct Candidate {
    pair: GeomPair,
    manifold: ContactManifold<(), ()>,
    /// Pose of the second shape in the frame of the first for which the contact points were computed.
    computed_at: Option<Pose>,
    /// Normal from the first shape to the second, in the frame of the first.
    axis: Vector3<f64>,
    /// Points on the surfaces of both shapes, each in the frame of its shape, m.
    points: Vec<[Point3<f64>; 2]>,
}

/// Geoms of a scene and the pairs of them that may touch.
#[derive(Clone)]
pub(super) struct Detector {
    solids: Vec<Solid>,
    /// Lists of the body pairs, in the order of the scene's contacts.
    lists: Vec<NearList>,
    prediction: f64,
    /// Whether a geom has round edges.
    pub has_round_shapes: bool,
}

impl Detector {
    /// Creates a detector that predicts contacts up to a gap of `prediction`, m.
    pub fn new(scene: &Scene, prediction: f64) -> Self {
        let mut solids: Vec<Solid> = Vec::new();
        let mut bodies = Vec::new();
        for (index, body) in scene.bodies.iter().enumerate() {
            let from = solids.len();
            solids.extend(body.geoms.iter().map(|geom| Solid::new(index, geom)));
            bodies.push((from..solids.len(), Arc::new(tree(&solids[from..]))));
        }
        for i in 0..solids.len() {
            let (own, (range, tree)) = (&solids[i], &bodies[solids[i].body]);
            let aabb = own.aabb.loosened(2.0 * COVER_DISTANCE);
            let found = tree.intersect_aabb(&aabb);
            let mut near: Vec<_> = found.map(|leaf| range.start + leaf as usize).collect();
            near.retain(|&j| j != i && !own.apart(&solids[j], COVER_DISTANCE));
            near.sort_unstable();
            let enclosed = |j: usize| solids[j].aabb.loosened(4.0 * COVER_TOLERANCE);
            let near = near.into_iter().map(|j| Neighbour { solid: j, aabb: enclosed(j) });
            solids[i].neighbours = near.collect();
        }
        let mut from = 0;
        let list = |pair: (usize, &ContactPair)| {
            let ends = [pair.1.first, pair.1.second].map(|body| bodies[body.0].clone());
            let list = NearList::new(pair, from, ends, &solids);
            from += list.pairs();
            list
        };
        let lists = scene.contacts.iter().enumerate().map(list).collect();
        let has_round_shapes = solids.iter().any(|solid| solid.round.is_some());
        Detector { lists, solids, prediction, has_round_shapes }
    }

    /// Detects the contacts at the bodies' poses and those predicted for a step of `step_s`, s.
    pub fn detect(&mut self, bodies: &[MovingBody], step_s: f64, touches: &mut Vec<Touch>) {
        touches.clear();
        for list in &mut self.lists {
            let [first, second] =
                [list.bodies.first, list.bodies.second].map(|body| bodies[body.0].pose);
            let (relative, many) = (first.inv_mul(&second), list.pairs() > MANY_PAIRS);
            list.renew(&relative, &self.solids, self.prediction);
            let prediction = match many {
                true => self.prediction.min(NEAR + step_s * list.speed(bodies)),
                false => self.prediction,
            };
            for &solid in &list.solids {
                let solid = &mut self.solids[solid];
                solid.enclose(&bodies[solid.body].pose);
            }
            if many {
                list.choose(&relative, &self.solids, prediction);
            }
            for pair in if many { &list.close } else { &list.near } {
                let [first, second] = pair.solids.map(|solid| &self.solids[solid]);
                if first.apart(second, prediction) || first.separated(second, prediction) {
                    continue;
                }
                let Some(candidate) = list.candidates.get_mut(&pair.number) else { continue };
                candidate.find(pair.number, bodies, &self.solids, prediction, touches);
            }
        }
        patches::join(touches);
    }
}

impl Solid {
    fn new(body: usize, geom: &Geom) -> Self {
        let (shape, turn) = shapes::shared(&geom.shape, MILLIMETRES);
        let (centre, half) = shapes::bounds(&geom.shape);
        let mut solid = Solid {
            body,
            friction: geom.friction,
            faces: faces(&shape),
            shape,
            round: match geom.shape {
                Shape::RoundBox { core, radius } => {
                    let half = core * MILLIMETRES;
                    Some((Cuboid::new(half.into()), radius * MILLIMETRES))
                }
                _ => None,
            },
            pose: geom.pose * turn,
            frame: geom.pose * Pose::translation(centre.x, centre.y, centre.z),
            half,
            aabb: Aabb::new_invalid(),
            enclosed_at: None,
            axes: Matrix3::identity(),
            centre: Vector3::zeros(),
            reach: centre.norm() + half.norm(),
            neighbours: Arc::new([]),
        };
        solid.enclose(&Pose::identity());
        solid
    }

    /// Returns the core, in parry's frame, and the radius, mm; without round edges, the shape itself and 0. `None` if
    /// parry has no support function for the shape.
    fn core(&self) -> Option<(&dyn SupportMap, f64)> {
        let round = self.round.as_ref().map(|(core, radius)| (core as &dyn SupportMap, *radius));
        round.or_else(|| Some((self.shape.as_support_map()?, 0.0)))
    }

    /// Updates enclosing box and bounding box in the world for a pose of the body.
    fn enclose(&mut self, body: &Pose) {
        if self.enclosed_at.as_ref() == Some(body) {
            return;
        }
        self.enclosed_at = Some(*body);
        let frame = body * self.frame;
        self.axes = frame.rotation.to_rotation_matrix().into_inner();
        self.centre = frame.translation.vector;
        let reach = self.axes.abs() * self.half;
        self.aabb = Aabb::from_half_extents(self.centre.into(), reach.into());
    }

    /// Returns whether the enclosing boxes are farther apart than a margin, m, along a face normal of one of them
    /// (separating axis test without the cross products of edges).
    fn separated(&self, other: &Solid, margin: f64) -> bool {
        let apart = self.centre - other.centre;
        let turn = self.axes.tr_mul(&other.axes);
        let own = self.axes.tr_mul(&apart).abs() - self.half - turn.abs() * other.half;
        let others = other.axes.tr_mul(&apart).abs() - other.half - turn.abs().tr_mul(&self.half);
        own.max() > margin || others.max() > margin
    }

    /// Returns whether the bounding boxes along the world's axes are farther apart than a margin, m.
    fn apart(&self, other: &Solid, margin: f64) -> bool {
        !self.aabb.loosened(margin).intersects(&other.aabb)
    }

    /// Returns whether a neighbour covers a point of the surface; point, m, and outward normal are in parry's frame of
    /// the shape.
    fn covered(&self, place: &Vector3<f64>, outward: &Vector3<f64>, solids: &[Solid]) -> bool {
        let outside = self.pose * Point3::from(place + outward * COVER_DISTANCE);
        self.neighbours.iter().any(|&Neighbour { solid: j, aabb }| {
            if !aabb.contains_local_point(outside.coords.into()) {
                return false;
            }
            let inside = solids[j].frame.inverse_transform_point(&outside).coords.abs();
            if (0..3).any(|i| inside[i] > solids[j].half[i] + 2.0 * COVER_TOLERANCE) {
                return false;
            }
            let local = solids[j].pose.inverse_transform_point(&outside).coords * MILLIMETRES;
            solids[j].distance(&local) < COVER_TOLERANCE * MILLIMETRES
        })
    }

    /// Returns the distance of a point in parry's frame from the shape, mm; 0 inside. Above [`COVER_TOLERANCE`] it is a
    /// lower bound.
    fn distance(&self, place: &Vector3<f64>) -> f64 {
        if let Some((core, radius)) = &self.round {
            let beside = place.abs() - Vector3::from(core.half_extents);
            return (beside.map(|distance| distance.max(0.0)).norm() - radius).max(0.0);
        }
        if !self.faces.is_empty() {
            let beyond = self.faces.iter().map(|(face, far)| face.dot(place) - far);
            let beyond = beyond.fold(f64::NEG_INFINITY, f64::max);
            if beyond <= 0.0 || beyond >= COVER_TOLERANCE * MILLIMETRES {
                return beyond.max(0.0);
            }
        }
        self.shape.distance_to_local_point((*place).into(), true)
    }
}

/// Returns the outward normals of a hull's faces and the distances of their planes from the origin, mm; none for other
/// shapes.
fn faces(shape: &SharedShape) -> Vec<(Vector3<f64>, f64)> {
    let Some(hull) = shape.as_convex_polyhedron() else { return Vec::new() };
    let farthest = |normal: &Vector3<f64>| {
        let distances = hull.points().iter().map(|point| Vector3::from(*point).dot(normal));
        distances.fold(f64::NEG_INFINITY, f64::max)
    };
    let normals = hull.faces().iter().map(|face| Vector3::from(face.normal));
    normals.map(|normal| (normal, farthest(&normal))).collect()
}

/// Returns whether no point within `reach`, m, of the origin has moved by `distance`, m, since a pose.
fn has_stayed(before: Option<&Pose>, now: &Pose, reach: f64, distance: f64) -> bool {
    before.is_some_and(|before| {
        let moved = (now.translation.vector - before.translation.vector).norm();
        // The norm is half the angle if that is small, and about 2 if the quaternion has changed its sign.
        let turned = now.rotation.coords - before.rotation.coords;
        moved + 2.0 * turned.norm() * reach < distance
    })
}

impl Candidate {
    fn new(pair: GeomPair) -> Self {
        let (manifold, points) = (ContactManifold::new(), Vec::new());
        Candidate { pair, manifold, computed_at: None, axis: Vector3::zeros(), points }
    }

    /// Appends the contact points at the bodies' poses; computes them again only if the geoms have moved.
    fn find(
        &mut self,
        geoms: usize,
        bodies: &[MovingBody],
        solids: &[Solid],
        prediction: f64,
        touches: &mut Vec<Touch>,
    ) {
        let [first, second] = [self.pair.first, self.pair.second].map(|solid| &solids[solid]);
        let pose = bodies[first.body].pose * first.pose;
        let other = bodies[second.body].pose * second.pose;
        let relative = pose.inv_mul(&other);
        let round = [first, second].map(|solid| solid.round.map_or(0.0, |(_, radius)| radius));
        let reuse = match round[0] + round[1] {
            0.0 => REUSE_DISTANCE,
            radius => REUSE_DISTANCE.min(REUSE_ANGLE * radius / MILLIMETRES),
        };
        if !has_stayed(self.computed_at.as_ref(), &relative, second.reach, reuse) {
            self.compute(&relative, (first, second), prediction);
            self.drop_covered(solids);
            self.choose(prediction);
            self.computed_at = Some(relative);
        }
        self.report(geoms, &pose, &relative, touches);
    }

    /// Computes the manifold from scratch.
    fn compute(&mut self, relative: &Pose, solids: (&Solid, &Solid), prediction: f64) {
        // parry would only update points that are still in the manifold.
        self.manifold.points.clear();
        let relative = shapes::pose(relative, MILLIMETRES);
        // There is no error: all shapes of a scene are convex.
        let _ = DefaultQueryDispatcher.contact_manifold_convex_convex(
            &relative,
            &*solids.0.shape,
            &*solids.1.shape,
            None,
            None,
            prediction * MILLIMETRES,
            &mut self.manifold,
        );
        if solids.0.round.is_some() || solids.1.round.is_some() {
            lines::add_ends(&mut self.manifold, &relative, [solids.0, solids.1], prediction);
        }
    }

    /// Removes the contact points that another geom of the same body covers: at a seam of flush parts, an edge that has
    /// penetrated by 0.1 um would catch on the hidden end face of the next part.
    fn drop_covered(&mut self, solids: &[Solid]) {
        let manifold = &mut self.manifold;
        let outward = [manifold.local_n1, manifold.local_n2].map(Vector3::from);
        let sides = [&solids[self.pair.first], &solids[self.pair.second]];
        if sides.iter().all(|side| side.neighbours.is_empty()) {
            return;
        }
        manifold.points.retain(|point| {
            let places = [point.local_p1, point.local_p2].map(Vector3::from);
            (0..2).all(|i| !sides[i].covered(&(places[i] / MILLIMETRES), &outward[i], solids))
        });
    }

    /// Stores the points within the prediction distance; if there are more than [`patches::MAX_POINTS`], only the
    /// extreme ones.
    fn choose(&mut self, prediction: f64) {
        let limit = prediction * MILLIMETRES;
        self.manifold.points.retain(|point| point.dist <= limit);
        let axis = Vector3::from(self.manifold.local_n1);
        self.axis = axis;
        self.points.clear();
        let points = &self.manifold.points;
        let place = |i: usize| Vector3::from(points[i].local_p1);
        let add = |i: usize| {
            let second = Vector3::from(points[i].local_p2);
            self.points.push([place(i), second].map(|place| Point3::from(place / MILLIMETRES)));
        };
        let count = points.len();
        if count <= patches::MAX_POINTS {
            return (0..count).for_each(add);
        }
        let middle = |i: usize| (place(i) + axis * (0.5 * points[i].dist)) / MILLIMETRES;
        let gap = |i: usize| points[i].dist / MILLIMETRES;
        patches::extremes(count, middle, gap, &axis).into_iter().for_each(add);
    }

    /// Appends the stored points with their current gaps.
    fn report(&self, geoms: usize, first: &Pose, relative: &Pose, touches: &mut Vec<Touch>) {
        let normal = first.rotation * self.axis;
        for [own, other] in &self.points {
            let gap = (relative * other - own).dot(&self.axis);
            touches.push(Touch {
                pair: self.pair.bodies,
                geoms,
                point: first * (own + self.axis * (0.5 * gap)),
                normal,
                gap,
                friction: self.pair.friction,
            });
        }
    }
}
