//! World of `direct`: one step from poses and velocities to the next.

use super::Direct;
use super::blocks::{Blocks, Vector6};
use super::body::MovingBody;
use super::cone::Cone;
use super::contacts::{Detector, Touch};
use super::joints::SpringJoint;
use super::patch::Patch;
use super::solver::{Contact, Solver, lever, offset_lever, point_velocity};
use crate::scene::{
    AxialFriction, BodyId, ContactPair, JointId, Motion, Pose, Scene, Spring, Torsion,
};
use crate::{ContactForce, ContactPoint, Diverged, World};
use nalgebra::{Vector3, Vector4};
use std::collections::BTreeMap;

/// Largest number of solves of a step, which are repeated until the servos at their limits are known.
const TRIES: usize = 5;

/// State of the simulation of a scene; a clone continues bit for bit as the original does.
#[derive(Clone)]
pub(super) struct DirectWorld {
    pub settings: Direct,
    gravity: Vector3<f64>,
    pub bodies: Vec<MovingBody>,
    /// Joints of the scene, then that of the axial friction, if any.
    joints: Vec<SpringJoint>,
    axial_friction: Option<AxialFriction>,
    /// Pairs of bodies that may touch.
    pub pairs: Vec<ContactPair>,
    /// Forces of the pairs over the last step.
    pub forces: Vec<ContactForce>,
    pub detector: Detector,
    system: Blocks,
    /// Right-hand side, then solution, by block row of the system matrix.
    values: Vec<Vector6>,
    /// Force at the centre of mass and moment applied to each body, N, N m.
    pushes: Vec<Vector6>,
    solver: Solver,
    pub touches: Vec<Touch>,
    /// Number of following steps to divide (`impact.rs`).
    pub divided: usize,
    contacts: Vec<Contact>,
    /// Contact patches by their numbers ([`Touch::geoms`]).
    patches: BTreeMap<usize, Patch>,
}

impl DirectWorld {
    pub fn new(scene: &Scene, settings: &Direct) -> Self {
        let (places, eliminated, size) = places(scene);
        let moving = scene.bodies.iter().zip(places).map(|(body, at)| MovingBody::new(body, at));
        let bodies: Vec<MovingBody> = moving.collect();
        let detector = Detector::new(scene, settings.prediction);
        let friction = scene.axial_friction.as_ref().map(SpringJoint::free);
        DirectWorld {
            settings: *settings,
            gravity: scene.gravity,
            joints: scene.joints.iter().map(SpringJoint::new).chain(friction).collect(),
            axial_friction: scene.axial_friction.clone(),
            pairs: scene.contacts.clone(),
            forces: vec![ContactForce::default(); scene.contacts.len()],
            patches: BTreeMap::new(),
            detector,
            system: Blocks::new(size, eliminated),
            values: vec![Vector6::zeros(); size],
            pushes: vec![Vector6::zeros(); scene.bodies.len()],
            solver: Solver::new(size - eliminated),
            touches: Vec::new(),
            divided: 0,
            contacts: Vec::new(),
            bodies,
        }
    }

    /// Sets up the detected contacts for the solver.
    fn set_contacts(&mut self) {
        let step = self.settings.step_s;
        self.contacts.clear();
        // Force at the end of the step: k gap + c rate; `share` weights the gap at the start of the step.
        let spring = self.settings.contact_stiffness * step;
        let share = spring / (spring + self.settings.contact_damping);
        let normal = share / (spring * step);
        let tangent = 1.0 / (self.settings.stick_damping * step);
        self.add_patches();
        for touch in &self.touches {
            let pair = &self.pairs[touch.pair];
            let ends = [&self.bodies[pair.first.0], &self.bodies[pair.second.0]];
            let place = ends.map(|body| body.place.map(|place| place - self.system.eliminated));
            let arm = ends.map(|body| touch.point - body.centre);
            let cone = Cone { mu: touch.friction.coefficient, normal, tangent };
            let lever = match touch.friction.torsion {
                Torsion::Radius(radius) => arm.map(|arm| lever(&arm, &(touch.normal * radius))),
                Torsion::Patch => {
                    let offset = |p: &Patch| p.offset(&ends[0].pose, &touch.point, &touch.normal);
                    let offset = self.patches.get(&touch.geoms).map_or(Vector3::zeros(), offset);
                    arm.map(|arm| offset_lever(&arm, &offset, &touch.normal))
                }
            };
            let mut drift = Vector4::zeros();
            for (body, lever, sign) in [(ends[0], &lever[0], -1.0), (ends[1], &lever[1], 1.0)] {
                if body.motion == Motion::Driven {
                    drift += point_velocity(lever, body.velocity.as_ref()) * sign;
                }
            }
            let closing = touch.gap / step;
            let bias = if touch.gap > 0.0 { closing } else { closing * share };
            let bias = bias.max(-self.settings.push_out);
            let (normal, rest) = (touch.normal.push(0.0), Contact::default());
            self.contacts.push(Contact { place, lever, normal, drift, bias, cone, ..rest });
        }
    }

    /// Adds the missing patches, with the loads of the solved contacts, or with equal loads if there are none yet.
    fn add_patches(&mut self) {
        let mut from = 0;
        for touches in self.touches.chunk_by(|a, b| a.geoms == b.geoms) {
            let Touch { geoms, pair, normal, friction, .. } = touches[0];
            let load = |i: usize| self.contacts.get(i).map_or(0.0, |c| c.impulse.dot(&c.normal));
            if friction.torsion == Torsion::Patch && !self.patches.contains_key(&geoms) {
                let frame = self.bodies[self.pairs[pair].first.0].pose.inverse();
                let loaded = |(i, touch): (usize, &Touch)| (frame * touch.point, load(from + i));
                let points: Vec<_> = touches.iter().enumerate().map(loaded).collect();
                self.patches.insert(geoms, Patch::new(&points, &(frame * normal)));
            }
            from += touches.len();
        }
    }

    /// Solves for the velocities at the end of the step, with the servos that are assumed to be at their limits.
    fn solve(&mut self) -> Option<()> {
        let step = self.settings.step_s;
        self.system.clear();
        for (body, push) in self.bodies.iter().zip(&self.pushes) {
            if let Some(place) = body.place {
                self.system.add(place, place, &body.mass());
                self.values[place] = body.momentum_after(&self.gravity, step) + push * step;
            }
        }
        for joint in &self.joints {
            joint.assemble(&self.bodies, step, &mut self.system, &mut self.values);
        }
        self.system.eliminate()?;
        self.system.reduce(&mut self.values);
        self.system.remainder(&mut self.solver.system);
        let free = &mut self.values[self.system.eliminated..];
        self.solver.rhs.copy_from_slice(free);
        self.solver.solve(&mut self.contacts, step)?;
        for (value, velocity) in free.iter_mut().zip(&self.solver.velocities) {
            *value = (*velocity).into();
        }
        self.system.expand(&mut self.values);
        Some(())
    }

    fn add_forces(&mut self) {
        self.forces.fill(ContactForce::default());
        let per_step = 1.0 / self.settings.step_s;
        for (touch, contact) in self.touches.iter().zip(&self.contacts) {
            let force = &mut self.forces[touch.pair];
            force.net += contact.impulse.xyz() * per_step;
            force.normal_sum += contact.impulse.dot(&contact.normal) * per_step;
        }
        let (Some(axial), Some(joint)) = (&self.axial_friction, self.joints.last()) else { return };
        let net = joint.friction(&self.bodies);
        for (pair, force) in self.pairs.iter().zip(&mut self.forces) {
            force.net += net * pair.sign(axial.parent, axial.child).unwrap_or(0.0);
        }
    }

    /// Sets the limit of the axial friction for the current poses.
    fn update_axial_friction(&mut self) {
        let Some(axial) = &self.axial_friction else { return };
        let Some(joint) = self.joints.last_mut() else { return };
        let [parent, child] = [axial.parent, axial.child].map(|body| &self.bodies[body.0].pose);
        joint.set_friction(axial.limit(parent, child), self.settings.stick_damping);
    }

    /// Takes a step with the detected contacts.
    pub(super) fn try_step(&mut self) -> Option<()> {
        let step = self.settings.step_s;
        for body in &mut self.bodies {
            body.steer(step);
            let free = body.place.and_then(|place| place.checked_sub(self.system.eliminated));
            if let Some(free) = free {
                self.solver.velocities[free] = body.velocity.into();
            }
        }
        for joint in &mut self.joints {
            joint.locate(&self.bodies);
        }
        self.update_axial_friction();
        self.set_contacts();
        for _ in 0..TRIES {
            self.solve()?;
            for body in &mut self.bodies {
                if let Some(place) = body.place {
                    body.velocity = self.values[place];
                }
            }
            let update =
                |all: bool, joint: &mut SpringJoint| joint.update_limits(&self.bodies, step) && all;
            if self.joints.iter_mut().fold(true, update) {
                break;
            }
        }
        self.add_forces();
        self.patches.clear();
        self.add_patches();
        for body in &mut self.bodies {
            body.advance(step);
        }
        self.bodies.iter().all(MovingBody::is_finite).then_some(())
    }
}

/// Returns the block row of each dynamic body in the system matrix (`None` for other bodies), the number of eliminated
/// bodies, and the number of dynamic bodies. Bodies without contacts come first, ordered by their number of joints, for
/// little fill-in.
fn places(scene: &Scene) -> (Vec<Option<usize>>, usize, usize) {
    let dynamic = |i: &usize| !matches!(scene.bodies[*i].motion, Motion::Fixed | Motion::Driven);
    let touching = |i: &usize| scene.contacts.iter().any(|pair| pair.contains(BodyId(*i)));
    let joints =
        |i: &usize| scene.joints.iter().filter(|j| j.parent.0 == *i || j.child.0 == *i).count();
    let mut order: Vec<usize> = (0..scene.bodies.len()).filter(dynamic).collect();
    order.sort_by_key(|i| (touching(i), joints(i)));
    let eliminated = order.iter().filter(|i| !touching(i)).count();
    let mut places = vec![None; scene.bodies.len()];
    for (place, &body) in order.iter().enumerate() {
        places[body] = Some(place);
    }
    (places, eliminated, order.len())
}

impl World for DirectWorld {
    fn step(&mut self) -> Result<(), Diverged> {
        self.detector.detect(&self.bodies, self.settings.step_s, &mut self.touches);
        let done = if self.divides_step() { self.divided_step() } else { self.try_step() };
        done.ok_or(Diverged)
    }

    fn step_s(&self) -> f64 {
        self.settings.step_s
    }

    fn set_step(&mut self, step_s: f64) {
        self.settings.step_s = step_s;
    }

    fn pose(&self, body: BodyId) -> Pose {
        self.bodies[body.0].pose
    }

    fn drive(&mut self, body: BodyId, pose: Pose) {
        self.bodies[body.0].target = pose;
    }

    fn place(&mut self, body: BodyId, pose: Pose) {
        self.bodies[body.0].put(pose);
    }

    fn set_spring(&mut self, joint: JointId, axis: usize, spring: Spring) {
        self.joints[joint.0].set(axis, spring);
    }

    fn push(&mut self, body: BodyId, force: Vector3<f64>, moment: Vector3<f64>) {
        let push = &mut self.pushes[body.0];
        push.fixed_rows_mut::<3>(0).copy_from(&force);
        push.fixed_rows_mut::<3>(3).copy_from(&moment);
    }

    fn contact(&self, first: BodyId, second: BodyId) -> ContactForce {
        let mut sum = ContactForce::default();
        for (pair, force) in self.pairs.iter().zip(&self.forces) {
            let Some(sign) = pair.sign(first, second) else { continue };
            sum.net += force.net * sign;
            sum.normal_sum += force.normal_sum;
        }
        sum
    }

    fn contact_points(&self, first: BodyId, second: BodyId) -> Vec<ContactPoint> {
        let per_step = 1.0 / self.settings.step_s;
        let point = |(touch, contact): (&Touch, &Contact)| {
            let sign = self.pairs.get(touch.pair)?.sign(first, second)?;
            let force = contact.impulse.xyz() * (sign * per_step);
            (force != Vector3::zeros()).then_some(ContactPoint { point: touch.point, force })
        };
        self.touches.iter().zip(&self.contacts).filter_map(point).collect()
    }

    fn snapshot(&self) -> Box<dyn World> {
        Box::new(self.clone())
    }
}
