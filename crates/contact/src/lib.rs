//! Contact engines behind one trait. They depend on scenes alone, not on studies.
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a defect; what input can reach is an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

use crate::scene::{Body, BodyId, Joint, JointId, Motion, Pose, Scene, Spring, Springs};
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

    /// Checks that it can simulate a scene exactly as it stands.
    ///
    /// # Errors
    /// If it lacks a feature that the scene needs, or refuses its numbers.
    fn supports(&self, _scene: &Scene) -> Result<(), Unsupported> {
        Ok(())
    }

    /// Returns whether face contacts have the friction of [`scene::Friction::torsion`].
    fn turns_with_friction(&self) -> bool {
        true
    }

    /// Creates the world at time zero of a scene that it [supports](Engine::supports).
    fn world(&self, scene: &Scene) -> Box<dyn World>;

    /// Returns the same engine with half the step, for trials that diverged.
    fn halved(&self) -> Box<dyn Engine>;

    /// Returns finer engines for convergence studies, each with its name.
    fn finer(&self) -> Vec<(&'static str, Box<dyn Engine>)> {
        vec![("half the step", self.halved())]
    }
}

/// Reason why an engine cannot simulate a scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unsupported {
    /// It lacks a feature that the scene needs.
    #[error(
        "the engine {engine} cannot simulate `{part}`: it has no {lacking}; use --engine direct"
    )]
    Lacking {
        /// Name and version of the engine.
        engine: String,
        /// Body or joint of the scene.
        part: String,
        /// Missing feature.
        lacking: &'static str,
    },
    /// It has all features, but refuses the numbers of the scene.
    #[error("the engine {engine} refuses these bodies: {reason}; use --engine direct")]
    Refused {
        /// Name and version of the engine.
        engine: String,
        /// Message of the engine.
        reason: String,
    },
}

/// Returns the parts of a scene that only `direct` can simulate, each with the feature that others lack:
/// springs that couple axes, friction of a patch, mass that depends on the direction.
fn lacking(scene: &Scene) -> impl DoubleEndedIterator<Item = (&str, &'static str)> {
    let coupled = |joint: &&Joint| matches!(joint.springs, Springs::Coupled { .. });
    let mechanism = |body: &&Body| matches!(body.motion, Motion::Mechanism(_));
    let joint = scene.joints.iter().find(coupled).map(|joint| joint.name.as_str());
    let patch = scene.patched().map(|pair| scene.bodies[pair.first.0].name.as_str());
    let body = scene.bodies.iter().find(mechanism).map(|body| body.name.as_str());
    let parts = [
        joint.map(|name| (name, "springs that couple the axes of a joint")),
        patch.map(|name| (name, "torsional friction of a pressed patch")),
        body.map(|name| (name, "mass that depends on the direction")),
    ];
    parts.into_iter().flatten()
}

/// Divergence: the state is no longer finite, and the trial has no result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the simulation diverged: a body's state is no longer finite")]
pub struct Diverged;

/// Contact between two bodies over the last step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactForce {
    /// Net force on the second body, with friction, N.
    pub net: Vector3<f64>,
    /// Sum of the magnitudes of the normal forces of all contact points, N.
    pub normal_sum: f64,
}

/// Point at which two bodies press on one another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Position, m.
    pub point: Point3<f64>,
    /// Force on the second body over the last step, with friction, N.
    pub force: Vector3<f64>,
}

impl ContactPoint {
    /// Returns the point in the frame that contains the old one at `from`.
    pub fn seen(&self, from: &Pose) -> Self {
        ContactPoint { point: from * self.point, force: from * self.force }
    }
}

/// Scene in simulation.
pub trait World: Send + Sync {
    /// Advances by one step.
    ///
    /// # Errors
    /// If the state is no longer finite.
    fn step(&mut self) -> Result<(), Diverged>;

    /// Returns the length of one step, s.
    fn step_s(&self) -> f64;

    /// Sets the length of the steps to come, s; an engine that cannot keeps its own.
    fn set_step(&mut self, _step_s: f64) {}

    /// Returns the frame of a body in the world.
    fn pose(&self, body: BodyId) -> Pose;

    /// Commands the pose of a driven body at the end of the next step.
    fn drive(&mut self, body: BodyId, pose: Pose);

    /// Moves a fixed body, which must touch nothing before and after.
    fn place(&mut self, body: BodyId, pose: Pose);

    /// Replaces the spring of an axis (0..6) of a joint that is a servo from the start.
    fn set_spring(&mut self, joint: JointId, axis: usize, spring: Spring);

    /// Applies a force at a free body's centre of mass, N, and a moment, N m, in world axes, in
    /// every step from now on, in place of those before.
    fn push(&mut self, body: BodyId, force: Vector3<f64>, moment: Vector3<f64>);

    /// Returns the contact between two bodies over the last step.
    fn contact(&self, first: BodyId, second: BodyId) -> ContactForce;

    /// Returns the points at which two bodies press on one another, for pictures; not every engine has them.
    fn contact_points(&self, _first: BodyId, _second: BodyId) -> Vec<ContactPoint> {
        Vec::new()
    }

    /// Returns an independent copy that continues with the same bits.
    fn snapshot(&self) -> Box<dyn World>;
}

impl Clone for Box<dyn World> {
    fn clone(&self) -> Self {
        self.snapshot()
    }
}
