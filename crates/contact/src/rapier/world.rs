//! World of `rapier`.

use super::Rapier;
use super::build::{self, JOINT_AXES};
use crate::scene::{BodyId, Joint, JointId, Pose, Scene, Spring};
use crate::{ContactForce, Diverged, World, shapes};
use nalgebra::Vector3;
use rapier3d_f64::prelude as rp;
use std::sync::Arc;

pub(super) struct RapierWorld {
    world: rp::PhysicsWorld,
    bodies: Vec<rp::RigidBodyHandle>,
    joints: Vec<rp::ImpulseJointHandle>,
    frictions: Arc<Frictions>,
}

/// Coefficient of friction of each two colliders, by the numbers in their user data.
struct Frictions {
    colliders: usize,
    coefficients: Vec<f64>,
}

impl Frictions {
    fn new(scene: &Scene) -> Self {
        let colliders = scene.bodies.iter().map(|body| body.geoms.len()).sum();
        let mut coefficients = vec![0.0; colliders * colliders];
        for pair in scene.geom_pairs() {
            for (i, j) in [(pair.first, pair.second), (pair.second, pair.first)] {
                coefficients[i * colliders + j] = pair.friction.coefficient;
            }
        }
        Frictions { colliders, coefficients }
    }
}

impl rp::PhysicsHooks for Frictions {
    fn modify_solver_contacts(&self, context: &mut rp::ContactModificationContext) {
        let ends = [context.collider1, context.collider2];
        let [i, j] = ends.map(|collider| context.colliders[collider].user_data as usize);
        if let Some(contact) = context.rigid_mut() {
            *contact.friction = self.coefficients[i * self.colliders + j];
        }
    }
}

impl RapierWorld {
    pub fn new(scene: &Scene, settings: &Rapier) -> Self {
        let mut world = rp::PhysicsWorld::new();
        world.gravity = scene.gravity.into();
        world.integration_parameters = build::parameters(settings);
        let bodies = build::insert_bodies(&mut world, scene);
        let mut insert = |joint: &Joint| {
            let (parent, child) = (bodies[joint.parent.0], bodies[joint.child.0]);
            world.impulse_joints.insert(parent, child, build::generic_joint(joint), true)
        };
        let joints = scene.joints.iter().map(&mut insert).collect();
        RapierWorld { world, bodies, joints, frictions: Arc::new(Frictions::new(scene)) }
    }
}

impl World for RapierWorld {
    fn step(&mut self) -> Result<(), Diverged> {
        self.world.step_with_events(&*self.frictions, &());
        // rapier freezes a body that left the finite numbers and reports it for one step only.
        if self.world.quarantine().is_empty() { Ok(()) } else { Err(Diverged) }
    }

    fn step_s(&self) -> f64 {
        self.world.integration_parameters.dt
    }

    fn pose(&self, body: BodyId) -> Pose {
        build::from_rapier(self.world.bodies[self.bodies[body.0]].position())
    }

    fn drive(&mut self, body: BodyId, pose: Pose) {
        let body = &mut self.world.bodies[self.bodies[body.0]];
        body.set_next_kinematic_position(shapes::pose(&pose, 1.0));
    }

    fn place(&mut self, body: BodyId, pose: Pose) {
        self.world.bodies[self.bodies[body.0]].set_position(shapes::pose(&pose, 1.0), true);
    }

    fn set_spring(&mut self, joint: JointId, axis: usize, spring: Spring) {
        if let Some(joint) = self.world.impulse_joints.get_mut(self.joints[joint.0], true) {
            build::set_motor(&mut joint.data, JOINT_AXES[axis], &spring);
        }
    }

    fn push(&mut self, body: BodyId, force: Vector3<f64>, moment: Vector3<f64>) {
        let body = &mut self.world.bodies[self.bodies[body.0]];
        // rapier adds up what it is given until told to forget it.
        body.reset_forces(true);
        body.reset_torques(true);
        body.add_force(force.into(), true);
        body.add_torque(moment.into(), true);
    }

    fn contact(&self, first: BodyId, second: BodyId) -> ContactForce {
        let ends = (self.bodies[first.0], self.bodies[second.0]);
        let mut sum = ContactForce::default();
        for &collider in self.world.bodies[ends.1].colliders() {
            for pair in self.world.narrow_phase.contact_pairs_with(collider) {
                add_pair(&mut sum, pair, ends, &self.world.integration_parameters);
            }
        }
        sum
    }

    fn snapshot(&self) -> Box<dyn World> {
        let from = &self.world;
        let world = rp::PhysicsWorld {
            gravity: from.gravity,
            integration_parameters: from.integration_parameters,
            islands: from.islands.clone(),
            broad_phase: from.broad_phase.clone(),
            narrow_phase: from.narrow_phase.clone(),
            bodies: from.bodies.clone(),
            colliders: from.colliders.clone(),
            impulse_joints: from.impulse_joints.clone(),
            ..rp::PhysicsWorld::new()
        };
        let (bodies, joints) = (self.bodies.clone(), self.joints.clone());
        Box::new(RapierWorld { world, bodies, joints, frictions: self.frictions.clone() })
    }
}

/// Adds the forces of one pair of colliders if it is between the two bodies.
fn add_pair(
    sum: &mut ContactForce,
    pair: &rp::ContactPair,
    (first, second): (rp::RigidBodyHandle, rp::RigidBodyHandle),
    parameters: &rp::IntegrationParameters,
) {
    for manifold in pair.solver_manifolds() {
        let sign = match (manifold.data.rigid_body1, manifold.data.rigid_body2) {
            // The manifold's normal points from its first body to its second.
            (Some(a), Some(b)) if (a, b) == (first, second) => 1.0,
            (Some(a), Some(b)) if (a, b) == (second, first) => -1.0,
            _ => continue,
        };
        // A point that is not active this time keeps what it bore when it last was.
        let active = || {
            let solved = manifold.data.solver_contacts.iter();
            solved.map(|contact| &manifold.points[contact.contact_indices()[0] as usize].data)
        };
        let pressed = active().map(|point| point.impulse).sum::<f64>() / parameters.dt;
        sum.net += Vector3::from(manifold.data.normal) * (sign * pressed);
        sum.normal_sum += pressed;
        // `Simplified` friction is one force for the whole manifold, repeated at each active point:
        // the impulse of the last substep alone, in the world's axes, on the first body.
        let Some(point) = active().next() else { continue };
        let rubbed = Vector3::from(point.warmstart_tangent_world);
        let substep = parameters.dt / parameters.num_solver_iterations as f64;
        sum.net -= rubbed * (sign / substep);
    }
}
