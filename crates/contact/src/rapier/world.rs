//! World of `rapier`.

use super::Rapier;
use crate::direct::Direct;
use crate::scene::{
    AxialFriction, Body, BodyId, Joint, JointId, Motion, Pose, Scene, Spring, Springs, sign,
};
use crate::{ContactForce, Diverged, World, shapes};
use nalgebra::{UnitQuaternion, Vector3};
use rapier3d_f64::prelude as rp;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Number of rapier's units of length, millimetres, in a metre: parry reuses the contact points and the normal of two
/// shapes until they have slid by 0.001 units, in metres the radius of an edge. Masses and times are in SI units.
const LENGTH: f64 = 1e3;
/// Factor from SI units to rapier's for moments and moments of inertia.
const MOMENT: f64 = LENGTH * LENGTH;

/// Simulation of a scene in rapier.
pub(super) struct RapierWorld {
    world: rp::PhysicsWorld,
    bodies: Vec<rp::RigidBodyHandle>,
    joints: Vec<rp::ImpulseJointHandle>,
    frictions: Arc<Frictions>,
    axial_friction: Option<(AxialFriction, rp::ImpulseJointHandle)>,
}

/// Coefficient of friction of each pair of colliders, by their numbers in the scene (geoms in order), which are their
/// user data.
struct Frictions(BTreeMap<[usize; 2], f64>);

impl rp::PhysicsHooks for Frictions {
    fn modify_solver_contacts(&self, context: &mut rp::ContactModificationContext) {
        let ends = [context.collider1, context.collider2];
        let ends = ends.map(|collider| context.colliders[collider].user_data as usize);
        if let (Some(contact), Some(coefficient)) = (context.rigid_mut(), self.0.get(&ends)) {
            *contact.friction = *coefficient;
        }
    }
}

impl RapierWorld {
    pub fn new(scene: &Scene, settings: &Rapier) -> Self {
        let mut world = rp::PhysicsWorld::new();
        world.gravity = (scene.gravity * LENGTH).into();
        world.integration_parameters = parameters(settings);
        let insert = |(body, group)| insert_body(&mut world, body, group);
        let bodies: Vec<_> = scene.bodies.iter().zip(groups(scene)).map(insert).collect();
        let mut insert = |parent: BodyId, child: BodyId, joint: rp::GenericJoint| {
            world.impulse_joints.insert(bodies[parent.0], bodies[child.0], joint, true)
        };
        let joint = |joint: &Joint| insert(joint.parent, joint.child, generic_joint(joint));
        let joints = scene.joints.iter().map(joint).collect();
        let frictions = scene.geom_pairs().into_iter().flat_map(|pair| {
            let coefficient = pair.friction.coefficient;
            [[pair.first, pair.second], [pair.second, pair.first]].map(|ends| (ends, coefficient))
        });
        let frictions = Arc::new(Frictions(frictions.collect()));
        let axial_friction = scene.axial_friction.clone().map(|friction| {
            let free = rp::GenericJoint::new(rp::JointAxesMask::empty());
            let joint = insert(friction.parent, friction.child, free);
            (friction, joint)
        });
        RapierWorld { world, bodies, joints, frictions, axial_friction }
    }

    /// Sets the limit of the axial friction for the current poses.
    fn update_axial_friction(&mut self) {
        let Some((friction, joint)) = &self.axial_friction else { return };
        let limit = friction.limit(&self.pose(friction.parent), &self.pose(friction.child));
        if let Some(joint) = self.world.impulse_joints.get_mut(*joint, true) {
            let damper = Spring { limit, ..Spring::new(0.0, Direct::default().stick_damping) };
            set_motor(&mut joint.data, rp::JointAxis::LinZ, &damper);
        }
    }

    /// Returns the axial friction over the last substep on the second of two bodies, world axes, N.
    fn axial_friction(&self, first: BodyId, second: BodyId) -> Option<Vector3<f64>> {
        let (friction, joint) = self.axial_friction.as_ref()?;
        let sign = sign((friction.parent, friction.child), (first, second))?;
        let motor = &self.world.impulse_joints.get(*joint)?.data.motors[2];
        let parameters = &self.world.integration_parameters;
        let substep = parameters.dt / parameters.num_solver_iterations as f64;
        // The impulse of the motor acts on the first body.
        let force = -sign * motor.impulse / substep / LENGTH;
        Some(self.pose(friction.parent).rotation * Vector3::z() * force)
    }
}

impl World for RapierWorld {
    fn step(&mut self) -> Result<(), Diverged> {
        self.update_axial_friction();
        self.world.step_with_events(&*self.frictions, &());
        // rapier freezes a body whose state is not finite, and reports it in one step only.
        if self.world.quarantine().is_empty() { Ok(()) } else { Err(Diverged) }
    }

    fn step_s(&self) -> f64 {
        self.world.integration_parameters.dt
    }

    fn pose(&self, body: BodyId) -> Pose {
        let pose = self.world.bodies[self.bodies[body.0]].position();
        let rotation = UnitQuaternion::new_unchecked(pose.rotation.into());
        Pose::from_parts((Vector3::from(pose.translation) / LENGTH).into(), rotation)
    }

    fn drive(&mut self, body: BodyId, pose: Pose) {
        let body = &mut self.world.bodies[self.bodies[body.0]];
        body.set_next_kinematic_position(shapes::pose(&pose, LENGTH));
    }

    fn place(&mut self, body: BodyId, pose: Pose) {
        self.world.bodies[self.bodies[body.0]].set_position(shapes::pose(&pose, LENGTH), true);
    }

    fn set_spring(&mut self, joint: JointId, axis: usize, spring: Spring) {
        if let Some(joint) = self.world.impulse_joints.get_mut(self.joints[joint.0], true) {
            set_motor(&mut joint.data, JOINT_AXES[axis], &spring);
        }
    }

    fn push(&mut self, body: BodyId, force: Vector3<f64>, moment: Vector3<f64>) {
        let body = &mut self.world.bodies[self.bodies[body.0]];
        // rapier adds up forces until they are reset.
        body.reset_forces(true);
        body.reset_torques(true);
        body.add_force((force * LENGTH).into(), true);
        body.add_torque((moment * MOMENT).into(), true);
    }

    fn contact(&self, first: BodyId, second: BodyId) -> ContactForce {
        let ends = (self.bodies[first.0], self.bodies[second.0]);
        let (world, parameters) = (&self.world, &self.world.integration_parameters);
        let mut sum = ContactForce::default();
        let colliders = world.bodies[ends.1].colliders().iter();
        let pairs = colliders.flat_map(|&collider| world.narrow_phase.contact_pairs_with(collider));
        for manifold in pairs.flat_map(|pair| pair.solver_manifolds()) {
            // The manifold's normal points from its first body to its second.
            let bodies = manifold.data.rigid_body1.zip(manifold.data.rigid_body2);
            let Some(sign) = bodies.and_then(|bodies| sign(ends, bodies)) else { continue };
            // An inactive point keeps the impulse of the last step in which it was active.
            let active = || {
                let solved = manifold.data.solver_contacts.iter();
                solved.map(|contact| &manifold.points[contact.contact_indices()[0] as usize].data)
            };
            let pressed = active().map(|point| point.impulse).sum::<f64>() / parameters.dt / LENGTH;
            sum.net += Vector3::from(manifold.data.normal) * (sign * pressed);
            sum.normal_sum += pressed;
            // `Simplified` friction is one force for the whole manifold, repeated at each active point:
            // the impulse of the last substep alone, in the world's axes, on the first body.
            let Some(point) = active().next() else { continue };
            let rubbed = Vector3::from(point.warmstart_tangent_world);
            let substep = parameters.dt / parameters.num_solver_iterations as f64;
            sum.net -= rubbed * (sign / substep / LENGTH);
        }
        sum.net += self.axial_friction(first, second).unwrap_or_default();
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
        let (frictions, axial_friction) = (self.frictions.clone(), self.axial_friction.clone());
        Box::new(RapierWorld { world, bodies, joints, frictions, axial_friction })
    }
}

/// Returns the integration parameters of rapier for these settings.
fn parameters(settings: &Rapier) -> rp::IntegrationParameters {
    let softness = rp::SpringCoefficients {
        natural_frequency: settings.contact_hz,
        damping_ratio: settings.contact_damping_ratio,
    };
    rp::IntegrationParameters {
        dt: settings.step_s,
        num_solver_iterations: settings.substeps,
        contact_softness: softness,
        static_contact_softness: softness,
        normalized_prediction_distance: settings.prediction * LENGTH,
        normalized_max_corrective_velocity: settings.corrective_velocity * LENGTH,
        normalized_allowed_linear_error: settings.allowed_error * LENGTH,
        // With recycling, a block slides 34 mm past an edge before it drops.
        contact_recycling: false,
        contact_clustering: false,
        max_ccd_substeps: 0,
        warmstart_joints: true,
        // With `Coulomb`, 2.8 % of the friction of a rotating face with four contact points is missing.
        friction_model: rp::FrictionModel::Simplified,
        ..Default::default()
    }
}

/// Returns the collision group of each body, filtered to the bodies it may touch.
fn groups(scene: &Scene) -> Vec<rp::InteractionGroups> {
    let bit = |i: usize| rp::Group::from_bits_truncate(1 << i);
    let group = |i| {
        let own = scene.contacts.iter().filter(|pair| pair.contains(BodyId(i)));
        let both = own.map(|pair| bit(pair.first.0) | bit(pair.second.0));
        let filter = both.fold(rp::Group::empty(), |all, two| all | two).difference(bit(i));
        rp::InteractionGroups::new(bit(i), filter, rp::InteractionTestMode::And)
    };
    (0..scene.bodies.len()).map(group).collect()
}

/// Inserts a body with its colliders.
fn insert_body(
    world: &mut rp::PhysicsWorld,
    body: &Body,
    group: rp::InteractionGroups,
) -> rp::RigidBodyHandle {
    let builder = match &body.motion {
        // `supports` rejects mechanisms.
        Motion::Fixed | Motion::Mechanism(_) => rp::RigidBodyBuilder::fixed(),
        Motion::Driven => rp::RigidBodyBuilder::kinematic_position_based(),
        Motion::Free(inertia) | Motion::Carried(inertia) => {
            let centre = (inertia.centre.coords * LENGTH).into();
            let moments = (inertia.moments * MOMENT).into();
            let properties = rp::MassProperties::new(centre, inertia.mass, moments);
            rp::RigidBodyBuilder::dynamic().additional_mass_properties(properties)
        }
    };
    let weight = if matches!(body.motion, Motion::Carried(_)) { 0.0 } else { 1.0 };
    let pose = shapes::pose(&body.pose, LENGTH);
    let handle = world.insert_body(builder.gravity_scale(weight).pose(pose).can_sleep(false));
    for geom in &body.geoms {
        let (shape, turn) = shapes::shared(&geom.shape, LENGTH);
        let collider = rp::ColliderBuilder::new(shape)
            .position(shapes::pose(&(geom.pose * turn), LENGTH))
            .density(0.0)
            .user_data(world.colliders.len() as u128)
            .active_hooks(rp::ActiveHooks::MODIFY_SOLVER_CONTACTS)
            .collision_groups(group);
        world.insert_collider(collider, Some(handle));
    }
    handle
}

/// Axes of a joint in the order of [`Springs::Axes`].
const JOINT_AXES: [rp::JointAxis; 6] = [
    rp::JointAxis::LinX,
    rp::JointAxis::LinY,
    rp::JointAxis::LinZ,
    rp::JointAxis::AngX,
    rp::JointAxis::AngY,
    rp::JointAxis::AngZ,
];

/// Returns the joint of rapier, with its springs as motors.
fn generic_joint(joint: &Joint) -> rp::GenericJoint {
    let mut made = rp::GenericJoint::new(rp::JointAxesMask::empty());
    made.set_local_frame1(shapes::pose(&joint.in_parent, LENGTH));
    made.set_local_frame2(shapes::pose(&joint.in_child, LENGTH));
    made.set_contacts_enabled(false);
    // `supports` rejects coupled springs.
    let Springs::Axes(axes) = &joint.springs else { return made };
    for (axis, spring) in JOINT_AXES.into_iter().zip(axes) {
        match spring {
            None => {
                made.lock_axes(axis.into());
            }
            Some(spring) => set_motor(&mut made, axis, spring),
        }
    }
    made
}

/// Sets the motor of an axis to a spring.
fn set_motor(joint: &mut rp::GenericJoint, axis: rp::JointAxis, spring: &Spring) {
    let turns = matches!(axis, rp::JointAxis::AngX | rp::JointAxis::AngY | rp::JointAxis::AngZ);
    // Factors from SI units: of the coordinate, and of stiffness and damping.
    let (coordinate_scale, spring_scale) = if turns { (1.0, MOMENT) } else { (LENGTH, 1.0) };
    joint.set_motor_model(axis, rp::MotorModel::ForceBased);
    let [stiffness, damping] = [spring.stiffness, spring.damping].map(|value| value * spring_scale);
    joint.set_motor(axis, spring.target * coordinate_scale, 0.0, stiffness, damping);
    let limit = spring.limit * coordinate_scale * spring_scale;
    joint.set_motor_max_force(axis, if limit.is_finite() { limit } else { f64::MAX });
}
