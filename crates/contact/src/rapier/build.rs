//! Bodies, joints and settings of rapier from those of a scene.

use super::Rapier;
use crate::scene::{Body, BodyId, Joint, Motion, Pose, Scene, Spring, Springs};
use crate::shapes;
use nalgebra::UnitQuaternion;
use rapier3d_f64::math as rm;
use rapier3d_f64::prelude as rp;

/// Settings of rapier.
pub(super) fn parameters(settings: &Rapier) -> rp::IntegrationParameters {
    let softness = rp::SpringCoefficients {
        natural_frequency: settings.contact_hz,
        damping_ratio: settings.contact_damping_ratio,
    };
    rp::IntegrationParameters {
        dt: settings.step_s,
        num_solver_iterations: settings.substeps,
        contact_softness: softness,
        static_contact_softness: softness,
        normalized_prediction_distance: settings.prediction,
        normalized_max_corrective_velocity: settings.corrective_velocity,
        normalized_allowed_linear_error: settings.allowed_error,
        // Recycled contacts let a block slide 34 mm past an edge before it drops.
        contact_recycling: false,
        contact_clustering: false,
        max_ccd_substeps: 0,
        warmstart_joints: true,
        // `Coulomb` lost 2.8 % of friction on a rotating four-point face.
        friction_model: rp::FrictionModel::Simplified,
        ..Default::default()
    }
}

/// Collision group of each body, filtered to the bodies it may touch.
fn groups(scene: &Scene) -> Vec<rp::InteractionGroups> {
    let bit = |i: usize| rp::Group::from_bits_truncate(1 << i);
    let group = |i| {
        let own = scene.contacts.iter().filter(|pair| pair.has(BodyId(i)));
        let both = own.map(|pair| bit(pair.first.0) | bit(pair.second.0));
        let filter = both.fold(rp::Group::empty(), |all, two| all | two).difference(bit(i));
        rp::InteractionGroups::new(bit(i), filter, rp::InteractionTestMode::And)
    };
    (0..scene.bodies.len()).map(group).collect()
}

/// Inserts the bodies with their colliders.
pub(super) fn insert_bodies(
    world: &mut rp::PhysicsWorld,
    scene: &Scene,
) -> Vec<rp::RigidBodyHandle> {
    let bodies = scene.bodies.iter().zip(groups(scene));
    bodies.map(|(body, group)| insert_body(world, body, group)).collect()
}

fn insert_body(
    world: &mut rp::PhysicsWorld,
    body: &Body,
    group: rp::InteractionGroups,
) -> rp::RigidBodyHandle {
    let builder = match &body.motion {
        // A mechanism's end is refused before; see `supports`.
        Motion::Fixed | Motion::Mechanism(_) => rp::RigidBodyBuilder::fixed(),
        Motion::Driven => rp::RigidBodyBuilder::kinematic_position_based(),
        Motion::Free(inertia) | Motion::Carried(inertia) => {
            let (centre, moments) = (inertia.centre.coords.into(), inertia.moments.into());
            let properties = rp::MassProperties::new(centre, inertia.mass, moments);
            rp::RigidBodyBuilder::dynamic().additional_mass_properties(properties)
        }
    };
    let weight = if matches!(body.motion, Motion::Carried(_)) { 0.0 } else { 1.0 };
    let pose = shapes::pose(&body.pose, 1.0);
    let handle = world.insert_body(builder.gravity_scale(weight).pose(pose).can_sleep(false));
    for geom in &body.geoms {
        let (shape, turn) = shapes::shared(&geom.shape, 1.0);
        let collider = rp::ColliderBuilder::new(shape)
            .position(shapes::pose(&(geom.pose * turn), 1.0))
            .density(0.0)
            .user_data(world.colliders.len() as u128)
            .active_hooks(rp::ActiveHooks::MODIFY_SOLVER_CONTACTS)
            .collision_groups(group);
        world.insert_collider(collider, Some(handle));
    }
    handle
}

/// Axes of a joint in our order.
pub(super) const JOINT_AXES: [rp::JointAxis; 6] = [
    rp::JointAxis::LinX,
    rp::JointAxis::LinY,
    rp::JointAxis::LinZ,
    rp::JointAxis::AngX,
    rp::JointAxis::AngY,
    rp::JointAxis::AngZ,
];

/// Joint with its springs.
pub(super) fn generic_joint(joint: &Joint) -> rp::GenericJoint {
    let mut made = rp::GenericJoint::new(rp::JointAxesMask::empty());
    made.set_local_frame1(shapes::pose(&joint.in_parent, 1.0));
    made.set_local_frame2(shapes::pose(&joint.in_child, 1.0));
    made.set_contacts_enabled(false);
    // Coupled springs are refused before; see `supports`.
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

/// Gives an axis its spring.
pub(super) fn set_motor(joint: &mut rp::GenericJoint, axis: rp::JointAxis, spring: &Spring) {
    joint.set_motor_model(axis, rp::MotorModel::ForceBased);
    joint.set_motor(axis, spring.target, 0.0, spring.stiffness, spring.damping);
    joint.set_motor_max_force(axis, if spring.limit.is_finite() { spring.limit } else { f64::MAX });
}

/// Pose from rapier's.
pub(super) fn from_rapier(pose: &rm::Pose) -> Pose {
    let rotation = UnitQuaternion::new_unchecked(pose.rotation.into());
    Pose::from_parts(pose.translation.into(), rotation)
}
