//! Simulation of rigid bodies in contact: scenes, and interchangeable engines that simulate them.

use crate::scene::{BodyId, JointId, Motion, Pose, Scene, Spring, Springs};
use nalgebra::{Point3, Vector3};

pub mod direct;
pub mod mjcf;
#[cfg(feature = "mujoco")]
pub mod mujoco;
pub mod rapier;
pub mod scene;
pub mod shapes;

/// Contact engine: builds worlds from scenes.
pub trait Engine: Send + Sync {
    /// Returns the name and version, as recorded in a study.
    fn version(&self) -> String;

    /// Checks that the engine can simulate a scene without simplifying it.
    ///
    /// # Errors
    /// If the engine lacks a feature that the scene needs, or rejects a value of the scene.
    fn supports(&self, _scene: &Scene) -> Result<(), Unsupported> {
        Ok(())
    }

    /// Creates the simulation, at time zero, of a scene that the engine [supports](Engine::supports).
    fn world(&self, scene: &Scene) -> Box<dyn World>;

    /// Returns the same engine with half the step, to repeat simulations that diverged, and for convergence checks.
    fn with_half_step(&self) -> Box<dyn Engine>;
}

/// Reason why an engine cannot simulate a scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unsupported {
    /// A feature that the scene needs is missing.
    #[error(
        "the engine {engine} cannot simulate `{part}`: it does not support {feature}; \
         use --engine direct"
    )]
    Lacking {
        /// Name and version of the engine.
        engine: String,
        /// Name of the body or joint.
        part: String,
        /// Missing feature.
        feature: &'static str,
    },
    /// The engine rejects a value of the scene.
    #[error("the engine {engine} rejects the scene: {reason}; use --engine direct")]
    Refused {
        /// Name and version of the engine.
        engine: String,
        /// Message of the engine.
        reason: String,
    },
}

/// Returns the first joint with coupled springs, the first body with a contact patch ([`scene::Torsion::Patch`]) and
/// the first mechanism of a scene, each by its name and with the feature that only `direct` has.
fn unsupported_parts(scene: &Scene) -> impl DoubleEndedIterator<Item = (&str, &'static str)> {
    let coupled = scene.joints.iter().find(|j| matches!(j.springs, Springs::Coupled { .. }));
    let pressed = scene.first_patch().map(|pair| &scene.bodies[pair.first.0]);
    let mechanism = scene.bodies.iter().find(|body| matches!(body.motion, Motion::Mechanism(_)));
    let parts = [
        coupled.map(|joint| (&*joint.name, "springs that couple the axes of a joint")),
        pressed.map(|body| (&*body.name, "torsional friction of a pressed patch")),
        mechanism.map(|body| (&*body.name, "mass that depends on the direction")),
    ];
    parts.into_iter().flatten()
}

/// Divergence: the state of the simulation is no longer finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the simulation diverged: a body's state is no longer finite")]
pub struct Diverged;

/// Contact force between two bodies over the last step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactForce {
    /// Net force on the second body, friction included, world axes, N.
    pub net: Vector3<f64>,
    /// Sum of the magnitudes of the normal forces of all contact points, N.
    pub normal_sum: f64,
}

/// Point at which two bodies press against each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Position in the world, m.
    pub point: Point3<f64>,
    /// Force on the second body over the last step, friction included, world axes, N.
    pub force: Vector3<f64>,
}

impl ContactPoint {
    /// Transforms the contact point to another frame; `frame` is the pose of the present frame in it.
    pub fn transformed(&self, frame: &Pose) -> Self {
        ContactPoint { point: frame * self.point, force: frame * self.force }
    }
}

/// Simulation of a scene.
pub trait World: Send + Sync {
    /// Advances by one step.
    ///
    /// # Errors
    /// If the state is no longer finite.
    fn step(&mut self) -> Result<(), Diverged>;

    /// Returns the length of one step, s.
    fn step_s(&self) -> f64;

    /// Sets the length of the following steps, s; engines with a fixed step ignore it.
    fn set_step(&mut self, _step_s: f64) {}

    /// Returns the pose of a body in the world.
    fn pose(&self, body: BodyId) -> Pose;

    /// Commands the pose of a driven body at the end of the next step.
    fn drive(&mut self, body: BodyId, pose: Pose);

    /// Moves a fixed body, which must have no contacts before or after.
    fn place(&mut self, body: BodyId, pose: Pose);

    /// Replaces the spring of an axis of a joint (order of [`Springs::Axes`]); in the scene the axis must be a servo: a
    /// spring with a limit.
    fn set_spring(&mut self, joint: JointId, axis: usize, spring: Spring);

    /// Sets the force at a free body's centre of mass, N, and the moment, N m, in world axes, that act
    /// on it in all following steps.
    fn push(&mut self, body: BodyId, force: Vector3<f64>, moment: Vector3<f64>);

    /// Returns the contact force between two bodies over the last step.
    fn contact(&self, first: BodyId, second: BodyId) -> ContactForce;

    /// Returns the contact points of two bodies, for pictures; empty for engines that do not report them.
    fn contact_points(&self, _first: BodyId, _second: BodyId) -> Vec<ContactPoint> {
        Vec::new()
    }

    /// Returns an independent copy, which continues bit for bit as this one does.
    fn snapshot(&self) -> Box<dyn World>;
}

impl Clone for Box<dyn World> {
    fn clone(&self) -> Self {
        self.snapshot()
    }
}
