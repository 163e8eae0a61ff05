//! Collision detection: the points at which the bodies of the listed pairs
//! touch or are about to. Nothing is carried over from step to step but parry's
//! guess of a separating direction, so a contact's normal is never out of date.

use super::body::Body;
use super::shapes;
use crate::scene::{Pose, Scene};
use nalgebra::{Point3, Vector3};
use parry::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry::shape::SharedShape;
use rapier3d_f64::parry;

/// At most so many points of a manifold are kept.
const POINTS: usize = 4;
/// A surface is covered if a neighbour is found this far out from it, m.
const COVER: f64 = 20e-6;
/// What a neighbour may be off by, m: more than contacts sink, less than any gap.
const SEAM: f64 = 2e-6;

/// A point of contact between two bodies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    /// Which of the scene's pairs of bodies.
    pub pair: usize,
    /// Midway between the two surfaces, world, m.
    pub point: Point3<f64>,
    /// Unit normal from the first body to the second, world.
    pub normal: Vector3<f64>,
    /// Signed distance, m; negative if they overlap.
    pub gap: f64,
    /// Coefficient of friction.
    pub friction: f64,
    /// Radius at which its friction resists a turn about the normal, m (see `Geom::patch`).
    pub patch: f64,
}

/// A shape on a body.
#[derive(Clone)]
struct Geom {
    body: usize,
    shape: SharedShape,
    /// parry's frame of the shape in the body frame.
    pose: Pose,
    /// Enclosing box in the body frame: frame and half extents, m.
    frame: Pose,
    half: Vector3<f64>,
    friction: f64,
    patch: f64,
    /// Enclosing box in the world, m.
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Other shapes of the same body that may cover a part of this one.
    neighbours: Vec<usize>,
}

/// Two shapes that may touch.
#[derive(Clone)]
struct Candidate {
    pair: usize,
    first: usize,
    second: usize,
    friction: f64,
    /// See `Geom::patch`.
    patch: f64,
    manifold: ContactManifold<(), ()>,
}

/// All shapes of a scene and the pairs that may touch.
#[derive(Clone)]
pub(super) struct Detector {
    geoms: Vec<Geom>,
    candidates: Vec<Candidate>,
    prediction: f64,
}

impl Detector {
    /// `prediction` is the gap, m, up to which a contact is foreseen.
    pub fn new(scene: &Scene, prediction: f64) -> Self {
        let mut geoms = Vec::new();
        let mut of_body = Vec::new();
        for (index, body) in scene.bodies.iter().enumerate() {
            let from = geoms.len();
            geoms.extend(body.geoms.iter().map(|geom| new_geom(index, geom)));
            of_body.push(from..geoms.len());
        }
        for range in &of_body {
            for i in range.clone() {
                geoms[i].enclose(&Pose::identity());
            }
            for i in range.clone() {
                let near = |&j: &usize| j != i && !geoms[i].apart(&geoms[j], COVER);
                geoms[i].neighbours = range.clone().filter(near).collect();
            }
        }
        let mut candidates = Vec::new();
        for (pair, (a, b)) in scene.contacts.iter().enumerate() {
            for first in of_body[a.0].clone() {
                for second in of_body[b.0].clone() {
                    let friction = geoms[first].friction.min(geoms[second].friction);
                    let manifold = ContactManifold::new();
                    // Two that leave it to the other have none.
                    let patch = Some(geoms[first].patch.min(geoms[second].patch))
                        .filter(|patch| patch.is_finite())
                        .unwrap_or(0.0);
                    candidates.push(Candidate { pair, first, second, friction, patch, manifold });
                }
            }
        }
        Detector { geoms, candidates, prediction }
    }

    /// Finds the contacts at the bodies' poses.
    pub fn detect(&mut self, bodies: &[Body], found: &mut Vec<Touch>) {
        found.clear();
        for geom in &mut self.geoms {
            geom.enclose(&bodies[geom.body].pose);
        }
        for candidate in &mut self.candidates {
            let (first, second) = (&self.geoms[candidate.first], &self.geoms[candidate.second]);
            if first.apart(second, self.prediction) {
                continue;
            }
            let pose = bodies[first.body].pose * first.pose;
            let other = bodies[second.body].pose * second.pose;
            candidate.meet(&pose, &other, (first, second), self.prediction);
            candidate.uncover(&self.geoms);
            candidate.report(&pose, self.prediction, found);
        }
    }
}

fn new_geom(body: usize, geom: &crate::scene::Geom) -> Geom {
    let (shape, turn) = shapes::shared(&geom.shape);
    let (centre, half) = shapes::bounds(&geom.shape);
    Geom {
        body,
        shape,
        pose: geom.pose * turn,
        frame: geom.pose * Pose::translation(centre.x, centre.y, centre.z),
        half,
        friction: geom.friction,
        patch: geom.patch,
        low: Vector3::zeros(),
        high: Vector3::zeros(),
        neighbours: Vec::new(),
    }
}

impl Geom {
    fn enclose(&mut self, body: &Pose) {
        let frame = body * self.frame;
        let reach = frame.rotation.to_rotation_matrix().into_inner().abs() * self.half;
        self.low = frame.translation.vector - reach;
        self.high = frame.translation.vector + reach;
    }

    fn apart(&self, other: &Geom, margin: f64) -> bool {
        (0..3).any(|i| self.low[i] > other.high[i] + margin || other.low[i] > self.high[i] + margin)
    }
}

impl Geom {
    /// Whether a neighbour covers a place on the surface, both in parry's frame of the shape, m.
    fn covered(&self, place: &Vector3<f64>, outward: &Vector3<f64>, geoms: &[Geom]) -> bool {
        let outside = self.pose * Point3::from(place + outward * COVER);
        self.neighbours.iter().any(|&j| {
            let local = geoms[j].pose.inverse_transform_point(&outside).coords * shapes::SCALE;
            let distance = geoms[j].shape.distance_to_local_point(shapes::vector(&local), true);
            distance < SEAM * shapes::SCALE
        })
    }
}

impl Candidate {
    /// Computes the manifold afresh.
    fn meet(&mut self, first: &Pose, second: &Pose, geoms: (&Geom, &Geom), prediction: f64) {
        // With points left in it parry would only move them along.
        self.manifold.points.clear();
        let relative = shapes::pose(&first.inv_mul(second));
        let result = DefaultQueryDispatcher.contact_manifold_convex_convex(
            &relative,
            &*geoms.0.shape,
            &*geoms.1.shape,
            None,
            None,
            prediction * shapes::SCALE,
            &mut self.manifold,
        );
        if result.is_err() {
            // Not reached: every shape that a scene can hold is convex.
            self.manifold.points.clear();
        }
    }

    /// Drops the points on faces that another shape of the same body covers: at
    /// a seam of two flush parts the hidden end face of the next part would stop
    /// an edge that slides along, 0.1 um deep, as if it were a step.
    fn uncover(&mut self, geoms: &[Geom]) {
        let manifold = &mut self.manifold;
        let outward = [manifold.local_n1, manifold.local_n2].map(shapes::from_vector);
        let sides = [&geoms[self.first], &geoms[self.second]];
        if sides.iter().all(|side| side.neighbours.is_empty()) {
            return;
        }
        manifold.points.retain(|point| {
            let places = [point.local_p1, point.local_p2].map(shapes::from_vector);
            (0..2).all(|i| !sides[i].covered(&(places[i] / shapes::SCALE), &outward[i], geoms))
        });
    }

    /// Adds the manifold's extreme points to the list.
    fn report(&mut self, first: &Pose, prediction: f64, found: &mut Vec<Touch>) {
        let limit = prediction * shapes::SCALE;
        self.manifold.points.retain(|point| point.dist <= limit);
        let normal = first.rotation * shapes::from_vector(self.manifold.local_n1);
        let axis = shapes::from_vector(self.manifold.local_n1);
        let middle = |i: usize| {
            let point = &self.manifold.points[i];
            (shapes::from_vector(point.local_p1) + axis * (0.5 * point.dist)) / shapes::SCALE
        };
        let mut add = |i: usize| {
            found.push(Touch {
                pair: self.pair,
                point: first * Point3::from(middle(i)),
                normal,
                gap: self.manifold.points[i].dist / shapes::SCALE,
                friction: self.friction,
                patch: self.patch,
            });
        };
        let count = self.manifold.points.len();
        if count <= POINTS {
            (0..count).for_each(add);
            return;
        }
        let deepest = best(count, |i| -self.manifold.points[i].dist);
        let far = best(count, |i| (middle(i) - middle(deepest)).norm_squared());
        let line = middle(far) - middle(deepest);
        let side = |i: usize| line.cross(&(middle(i) - middle(deepest))).dot(&axis);
        let mut chosen = [deepest, far, best(count, side), best(count, |i| -side(i))];
        chosen.sort_unstable();
        for (k, &i) in chosen.iter().enumerate() {
            if k == 0 || chosen[k - 1] != i {
                add(i);
            }
        }
    }
}

/// The first index below `count` with the largest value.
fn best(count: usize, value: impl Fn(usize) -> f64) -> usize {
    let start = (0, f64::NEG_INFINITY);
    let keep = |best: (usize, f64), i: usize| {
        let now = value(i);
        if now > best.1 { (i, now) } else { best }
    };
    (0..count).fold(start, keep).0
}
