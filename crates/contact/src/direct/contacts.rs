//! Collision detection: the points at which the bodies of the listed pairs
//! touch or are about to. Nothing is carried over from step to step but parry's
//! guess of a separating direction, so a contact's normal is never out of date.

use super::body::MovingBody;
use crate::scene::{Friction, Geom, GeomPair, Pose, Scene};
use crate::shapes;
use nalgebra::{Point3, Vector3};
use parry::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry::shape::SharedShape;
use rapier3d_f64::parry;

/// Shapes are in millimetres, so many to a metre: some of parry's tolerances are
/// absolute and made for metre-sized things (in metres it drops the crossing of two
/// edges of 1 mm that meet at less than a degree).
const MILLIMETRES: f64 = 1e3;
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
    /// Which of its pairs of geoms; their points follow one another.
    pub geoms: usize,
    /// Midway between the two surfaces, world, m.
    pub point: Point3<f64>,
    /// Unit normal from the first body to the second, world.
    pub normal: Vector3<f64>,
    /// Signed distance, m; negative if they overlap.
    pub gap: f64,
    /// Of the two surfaces.
    pub friction: Friction,
}

/// A geom as parry has it.
#[derive(Clone)]
struct Solid {
    body: usize,
    shape: SharedShape,
    /// parry's frame of the shape in the body frame.
    pose: Pose,
    /// Enclosing box in the body frame: frame and half extents, m.
    frame: Pose,
    half: Vector3<f64>,
    /// Enclosing box in the world, m.
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Other shapes of the same body that may cover a part of this one.
    neighbours: Vec<usize>,
}

/// Two shapes that may touch.
#[derive(Clone)]
struct Candidate {
    pair: GeomPair,
    manifold: ContactManifold<(), ()>,
}

/// All shapes of a scene and the pairs that may touch.
#[derive(Clone)]
pub(super) struct Detector {
    solids: Vec<Solid>,
    candidates: Vec<Candidate>,
    prediction: f64,
}

impl Detector {
    /// `prediction` is the gap, m, up to which a contact is foreseen.
    pub fn new(scene: &Scene, prediction: f64) -> Self {
        let mut solids: Vec<Solid> = Vec::new();
        for (index, body) in scene.bodies.iter().enumerate() {
            solids.extend(body.geoms.iter().map(|geom| Solid::new(index, geom)));
        }
        for solid in &mut solids {
            solid.enclose(&Pose::identity());
        }
        for i in 0..solids.len() {
            let (own, all) = (&solids[i], 0..solids.len());
            let near =
                |&j: &usize| j != i && solids[j].body == own.body && !own.apart(&solids[j], COVER);
            solids[i].neighbours = all.filter(near).collect();
        }
        let candidate = |pair: GeomPair| Candidate { pair, manifold: ContactManifold::new() };
        let candidates = scene.geom_pairs().into_iter().map(candidate).collect();
        Detector { solids, candidates, prediction }
    }

    /// How many pairs of geoms there are.
    pub fn pairs(&self) -> usize {
        self.candidates.len()
    }

    /// Finds the contacts at the bodies' poses.
    pub fn detect(&mut self, bodies: &[MovingBody], found: &mut Vec<Touch>) {
        found.clear();
        for solid in &mut self.solids {
            solid.enclose(&bodies[solid.body].pose);
        }
        for (geoms, candidate) in self.candidates.iter_mut().enumerate() {
            let (first, second) =
                (&self.solids[candidate.pair.first], &self.solids[candidate.pair.second]);
            if first.apart(second, self.prediction) {
                continue;
            }
            let pose = bodies[first.body].pose * first.pose;
            let other = bodies[second.body].pose * second.pose;
            candidate.compute(&pose, &other, (first, second), self.prediction);
            candidate.drop_covered(&self.solids);
            candidate.report(geoms, &pose, self.prediction, found);
        }
    }
}

impl Solid {
    fn new(body: usize, geom: &Geom) -> Self {
        let (shape, turn) = shapes::shared(&geom.shape, MILLIMETRES);
        let (centre, half) = shapes::bounds(&geom.shape);
        Solid {
            body,
            shape,
            pose: geom.pose * turn,
            frame: geom.pose * Pose::translation(centre.x, centre.y, centre.z),
            half,
            low: Vector3::zeros(),
            high: Vector3::zeros(),
            neighbours: Vec::new(),
        }
    }

    fn enclose(&mut self, body: &Pose) {
        let frame = body * self.frame;
        let reach = frame.rotation.to_rotation_matrix().into_inner().abs() * self.half;
        self.low = frame.translation.vector - reach;
        self.high = frame.translation.vector + reach;
    }

    fn apart(&self, other: &Solid, margin: f64) -> bool {
        (0..3).any(|i| self.low[i] > other.high[i] + margin || other.low[i] > self.high[i] + margin)
    }

    /// Whether a neighbour covers a place on the surface, both in parry's frame of the shape, m.
    fn covered(&self, place: &Vector3<f64>, outward: &Vector3<f64>, solids: &[Solid]) -> bool {
        let outside = self.pose * Point3::from(place + outward * COVER);
        self.neighbours.iter().any(|&j| {
            let boxed = solids[j].frame.inverse_transform_point(&outside).coords.abs();
            if (0..3).any(|i| boxed[i] > solids[j].half[i] + 2.0 * SEAM) {
                return false;
            }
            let local = solids[j].pose.inverse_transform_point(&outside).coords * MILLIMETRES;
            let distance = solids[j].shape.distance_to_local_point(shapes::vector(&local), true);
            distance < SEAM * MILLIMETRES
        })
    }
}

impl Candidate {
    /// Computes the manifold afresh.
    fn compute(&mut self, first: &Pose, second: &Pose, solids: (&Solid, &Solid), prediction: f64) {
        // With points left in it parry would only move them along.
        self.manifold.points.clear();
        let relative = shapes::pose(&first.inv_mul(second), MILLIMETRES);
        let result = DefaultQueryDispatcher.contact_manifold_convex_convex(
            &relative,
            &*solids.0.shape,
            &*solids.1.shape,
            None,
            None,
            prediction * MILLIMETRES,
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
    fn drop_covered(&mut self, solids: &[Solid]) {
        let manifold = &mut self.manifold;
        let outward = [manifold.local_n1, manifold.local_n2].map(shapes::from_vector);
        let sides = [&solids[self.pair.first], &solids[self.pair.second]];
        if sides.iter().all(|side| side.neighbours.is_empty()) {
            return;
        }
        manifold.points.retain(|point| {
            let places = [point.local_p1, point.local_p2].map(shapes::from_vector);
            (0..2).all(|i| !sides[i].covered(&(places[i] / MILLIMETRES), &outward[i], solids))
        });
    }

    /// Adds the manifold's extreme points to the list.
    fn report(&mut self, geoms: usize, first: &Pose, prediction: f64, found: &mut Vec<Touch>) {
        let limit = prediction * MILLIMETRES;
        self.manifold.points.retain(|point| point.dist <= limit);
        let normal = first.rotation * shapes::from_vector(self.manifold.local_n1);
        let axis = shapes::from_vector(self.manifold.local_n1);
        let middle = |i: usize| {
            let point = &self.manifold.points[i];
            (shapes::from_vector(point.local_p1) + axis * (0.5 * point.dist)) / MILLIMETRES
        };
        let mut add = |i: usize| {
            found.push(Touch {
                pair: self.pair.bodies,
                geoms,
                point: first * Point3::from(middle(i)),
                normal,
                gap: self.manifold.points[i].dist / MILLIMETRES,
                friction: self.pair.friction,
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
