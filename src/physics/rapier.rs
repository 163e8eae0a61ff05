//! The production engine: rapier3d in double precision. The only file that knows it.

use super::{ContactForce, Diverged, Engine, Unsupported, World, refuse_coupling};
use crate::scene::{self, Axis, BodyId, JointId, Motion, Pose, Scene, Shape, Spring, Springs};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rapier3d_f64::math as rm;
use rapier3d_f64::prelude as rp;

/// Contact and solver settings for millimetre-sized parts. rapier's defaults
/// are for metre-sized games and are wrong here (a 10 N push sinks 0.7 mm).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Settings {
    /// Length of a step, s; collisions are detected once per step.
    pub step_s: f64,
    /// Solver substeps in a step.
    pub substeps: usize,
    /// Natural frequency of a contact, Hz. rapier scales a contact's stiffness
    /// with the effective mass: a 5 g connector wedged by 70 N sinks 0.21 mm into
    /// a wall at 2 kHz, 0.024 mm at 6 kHz, 0.014 mm at 8 kHz (check T10). But a
    /// contact that is too stiff for the length of a substep, beyond about
    /// `2 pi f h = 1.7`, chatters when a part is squeezed between two others, and
    /// so lets it slip: at 4 substeps of 25 us from 12 kHz (check T5).
    pub contact_hz: f64,
    /// Damping ratio of a contact; 1 is critical.
    pub contact_damping_ratio: f64,
    /// Distance at which a contact is foreseen, m: farther than anything moves
    /// in a step, smaller than the gaps between faces that must not interact.
    pub prediction: f64,
    /// Fastest a penetration is pushed out, m/s. This bounds the force that a
    /// contact can bear: at 0.5 m/s a 5 g connector wedged by 70 N sinks 2.4 mm
    /// at 2 kHz, and one wedged by 200 N sinks 1.1 mm at 8 kHz (check T10). So it
    /// must be out of reach; here it bears some 3 kN on such a part.
    pub corrective_velocity: f64,
    /// Penetration that is not corrected, m.
    pub allowed_error: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            step_s: 1e-4,
            substeps: 4,
            contact_hz: 8e3,
            contact_damping_ratio: 1.0,
            prediction: 0.5e-3,
            corrective_velocity: 10.0,
            allowed_error: 1e-7,
        }
    }
}

/// The engine; see [`Settings`].
#[derive(Debug, Clone, Copy, Default)]
pub struct Rapier {
    /// How finely and how stiffly it simulates.
    pub settings: Settings,
}

impl Engine for Rapier {
    fn version(&self) -> String {
        format!("rapier3d-f64 {}", rapier3d_f64::VERSION)
    }

    fn turns_with_friction(&self) -> bool {
        false
    }

    fn supports(&self, scene: &Scene) -> Result<(), Unsupported> {
        refuse_coupling(self, scene)
    }

    /// # Panics
    /// On a scene that it does not support.
    fn world(&self, scene: &Scene) -> Box<dyn World> {
        if let Err(unsupported) = self.supports(scene) {
            panic!("{unsupported}");
        }
        Box::new(RapierWorld::new(scene, &self.settings))
    }

    fn halved(&self) -> Box<dyn Engine> {
        let step_s = 0.5 * self.settings.step_s;
        Box::new(Rapier { settings: Settings { step_s, ..self.settings } })
    }

    fn finer(&self) -> Vec<(&'static str, Box<dyn Engine>)> {
        let substeps = 2 * self.settings.substeps;
        let settings = Settings { substeps, ..self.settings };
        vec![
            ("half the step", self.halved()),
            ("twice the substeps", Box::new(Rapier { settings })),
        ]
    }
}

struct RapierWorld {
    world: rp::PhysicsWorld,
    bodies: Vec<rp::RigidBodyHandle>,
    joints: Vec<rp::ImpulseJointHandle>,
}

impl RapierWorld {
    fn new(scene: &Scene, settings: &Settings) -> Self {
        let mut world = rp::PhysicsWorld::new();
        world.gravity = vector(&scene.gravity);
        world.integration_parameters = parameters(settings);
        let groups = groups(scene);
        let bodies: Vec<_> = scene
            .bodies
            .iter()
            .zip(&groups)
            .map(|(body, &group)| insert_body(&mut world, body, group))
            .collect();
        let joints = scene
            .joints
            .iter()
            .map(|joint| {
                let ends = (bodies[joint.parent.0], bodies[joint.child.0]);
                world.impulse_joints.insert(ends.0, ends.1, generic_joint(joint), true)
            })
            .collect();
        RapierWorld { world, bodies, joints }
    }
}

impl World for RapierWorld {
    fn step(&mut self) -> Result<(), Diverged> {
        self.world.step();
        // rapier freezes a body that left the finite numbers and reports it for one step only.
        if self.world.quarantine().is_empty() { Ok(()) } else { Err(Diverged) }
    }

    fn step_s(&self) -> f64 {
        self.world.integration_parameters.dt
    }

    fn pose(&self, body: BodyId) -> Pose {
        from_rapier(self.world.bodies[self.bodies[body.0]].position())
    }

    fn drive(&mut self, body: BodyId, pose: Pose) {
        self.world.bodies[self.bodies[body.0]].set_next_kinematic_position(to_rapier(&pose));
    }

    fn place(&mut self, body: BodyId, pose: Pose) {
        self.world.bodies[self.bodies[body.0]].set_position(to_rapier(&pose), true);
    }

    fn set_spring(&mut self, joint: JointId, axis: usize, spring: Spring) {
        if let Some(joint) = self.world.impulse_joints.get_mut(self.joints[joint.0], true) {
            set_motor(&mut joint.data, AXES[axis], &spring);
        }
    }

    fn push(&mut self, body: BodyId, force: Vector3<f64>, moment: Vector3<f64>) {
        let body = &mut self.world.bodies[self.bodies[body.0]];
        // rapier adds up what it is given until told to forget it.
        body.reset_forces(true);
        body.reset_torques(true);
        body.add_force(vector(&force), true);
        body.add_torque(vector(&moment), true);
    }

    fn contact(&self, first: BodyId, second: BodyId) -> ContactForce {
        let per_step = 1.0 / self.world.integration_parameters.dt;
        let (first, second) = (self.bodies[first.0], self.bodies[second.0]);
        let mut sum = ContactForce { net: Vector3::zeros(), normal_sum: 0.0 };
        for &collider in self.world.bodies[second].colliders() {
            for pair in self.world.narrow_phase.contact_pairs_with(collider) {
                add_pair(&mut sum, pair, first, second);
            }
        }
        sum.net *= per_step;
        sum.normal_sum *= per_step;
        sum
    }

    fn snapshot(&self) -> Box<dyn World> {
        let from = &self.world;
        let mut world = rp::PhysicsWorld::new();
        world.gravity = from.gravity;
        world.integration_parameters = from.integration_parameters;
        world.islands = from.islands.clone();
        world.broad_phase = from.broad_phase.clone();
        world.narrow_phase = from.narrow_phase.clone();
        world.bodies = from.bodies.clone();
        world.colliders = from.colliders.clone();
        world.impulse_joints = from.impulse_joints.clone();
        Box::new(RapierWorld { world, bodies: self.bodies.clone(), joints: self.joints.clone() })
    }
}

/// Adds the impulses of one pair if it is between the two bodies.
fn add_pair(
    sum: &mut ContactForce,
    pair: &rp::ContactPair,
    first: rp::RigidBodyHandle,
    second: rp::RigidBodyHandle,
) {
    for manifold in pair.solver_manifolds() {
        let sign = match (manifold.data.rigid_body1, manifold.data.rigid_body2) {
            // The manifold's normal points from its first body to its second.
            (Some(a), Some(b)) if (a, b) == (first, second) => 1.0,
            (Some(a), Some(b)) if (a, b) == (second, first) => -1.0,
            _ => continue,
        };
        let impulse: f64 = manifold.points.iter().map(|point| point.data.impulse).sum();
        let normal = manifold.data.normal;
        sum.net += sign * impulse * Vector3::new(normal.x, normal.y, normal.z);
        sum.normal_sum += impulse;
    }
}

fn parameters(settings: &Settings) -> rp::IntegrationParameters {
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

/// One collision group per body, filtered to the bodies it may touch.
fn groups(scene: &Scene) -> Vec<rp::InteractionGroups> {
    let bit = |i: usize| rp::Group::from_bits_truncate(1 << i);
    (0..scene.bodies.len())
        .map(|i| {
            let touches = scene.contacts.iter().filter_map(|&(a, b)| match (a.0, b.0) {
                (a, b) if a == i => Some(bit(b)),
                (a, b) if b == i => Some(bit(a)),
                _ => None,
            });
            let filter = touches.fold(rp::Group::empty(), |all, one| all | one);
            rp::InteractionGroups::new(bit(i), filter, rp::InteractionTestMode::And)
        })
        .collect()
}

fn insert_body(
    world: &mut rp::PhysicsWorld,
    body: &scene::Body,
    group: rp::InteractionGroups,
) -> rp::RigidBodyHandle {
    let builder = match &body.motion {
        // A mechanism's end is refused before; see `supports`.
        Motion::Fixed | Motion::Mechanism(_) => rp::RigidBodyBuilder::fixed(),
        Motion::Driven => rp::RigidBodyBuilder::kinematic_position_based(),
        Motion::Free(inertia) | Motion::Carried(inertia) => {
            let centre = vector(&inertia.centre.coords);
            let moments = vector(&inertia.moments);
            rp::RigidBodyBuilder::dynamic().additional_mass_properties(rp::MassProperties::new(
                centre,
                inertia.mass,
                moments,
            ))
        }
    };
    let weight = if matches!(body.motion, Motion::Carried(_)) { 0.0 } else { 1.0 };
    let builder = builder.gravity_scale(weight).pose(to_rapier(&body.pose)).can_sleep(false);
    let handle = world.insert_body(builder);
    for geom in &body.geoms {
        let (shape, turn) = shared_shape(&geom.shape);
        let collider = rp::ColliderBuilder::new(shape)
            .position(to_rapier(&(geom.pose * turn)))
            .density(0.0)
            .friction(geom.friction)
            .friction_combine_rule(rp::CoefficientCombineRule::Min)
            .collision_groups(group);
        world.insert_collider(collider, Some(handle));
    }
    handle
}

/// The shape, and the turn from rapier's frame of it to ours.
fn shared_shape(shape: &Shape) -> (rp::SharedShape, Pose) {
    match shape {
        Shape::Box { half } => (rp::SharedShape::cuboid(half.x, half.y, half.z), Pose::identity()),
        Shape::Cylinder { half_height, radius } => {
            // rapier's cylinders stand along y, ours along z.
            let turn =
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
            let shape = rp::SharedShape::cylinder(*half_height, *radius);
            (shape, Pose::from_parts(Translation3::identity(), turn))
        }
        Shape::Hull { points } => {
            let points: Vec<_> = points.iter().map(|p| vector(&p.coords)).collect();
            // The task file's checks leave no degenerate hull; a ball would be seen at once.
            let hull = rp::SharedShape::convex_hull(&points);
            (hull.unwrap_or_else(|| rp::SharedShape::ball(0.0)), Pose::identity())
        }
    }
}

const AXES: [rp::JointAxis; 6] = [
    rp::JointAxis::LinX,
    rp::JointAxis::LinY,
    rp::JointAxis::LinZ,
    rp::JointAxis::AngX,
    rp::JointAxis::AngY,
    rp::JointAxis::AngZ,
];

fn generic_joint(joint: &scene::Joint) -> rp::GenericJoint {
    let mut made = rp::GenericJoint::new(rp::JointAxesMask::empty());
    made.set_local_frame1(to_rapier(&joint.in_parent));
    made.set_local_frame2(to_rapier(&joint.in_child));
    made.set_contacts_enabled(false);
    // Coupled springs are refused before; see `supports`.
    let Springs::Axes(axes) = &joint.springs else { return made };
    for (axis, spring) in AXES.into_iter().zip(axes) {
        match spring {
            Axis::Locked => {
                made.lock_axes(axis.into());
            }
            Axis::Sprung(spring) => set_motor(&mut made, axis, spring),
        }
    }
    made
}

fn set_motor(joint: &mut rp::GenericJoint, axis: rp::JointAxis, spring: &Spring) {
    joint.set_motor_model(axis, rp::MotorModel::ForceBased);
    joint.set_motor(axis, spring.target, 0.0, spring.stiffness, spring.damping);
    joint.set_motor_max_force(axis, if spring.limit.is_finite() { spring.limit } else { f64::MAX });
}

fn vector(v: &Vector3<f64>) -> rm::Vector {
    rm::Vector::new(v.x, v.y, v.z)
}

fn to_rapier(pose: &Pose) -> rm::Pose {
    let q = pose.rotation.coords;
    let rotation = rm::Rotation::from_xyzw(q.x, q.y, q.z, q.w);
    rm::Pose::from_parts(vector(&pose.translation.vector), rotation)
}

fn from_rapier(pose: &rm::Pose) -> Pose {
    let (t, q) = (pose.translation, pose.rotation);
    let quaternion = nalgebra::Quaternion::new(q.w, q.x, q.y, q.z);
    Pose::from_parts(Translation3::new(t.x, t.y, t.z), UnitQuaternion::new_unchecked(quaternion))
}
