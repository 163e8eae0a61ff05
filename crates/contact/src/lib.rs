//! Contact engines behind one trait; they know scenes, not studies.
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
mod surface;

pub use surface::{Surface, surface};

/// Builds worlds from scenes.
pub trait Engine: Send + Sync {
    /// Name and version, as recorded in a study.
    fn version(&self) -> String;

    /// Whether it can simulate a scene exactly as it stands.
    fn supports(&self, _scene: &Scene) -> Result<(), Unsupported> {
        Ok(())
    }

    /// Whether a face contact resists a turn about its normal by [`crate::scene::Friction::torsion`].
    fn turns_with_friction(&self) -> bool {
        true
    }

    /// A world at time zero, of a scene that it [supports](Engine::supports).
    fn world(&self, scene: &Scene) -> Box<dyn World>;

    /// The same engine with half the step, for what diverged.
    fn halved(&self) -> Box<dyn Engine>;

    /// The same engine, finer in one way each, and what that way is: for convergence studies.
    fn finer(&self) -> Vec<(&'static str, Box<dyn Engine>)> {
        vec![("half the step", self.halved())]
    }
}

/// An engine cannot simulate a scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unsupported {
    /// It lacks what a scene needs.
    #[error(
        "the engine {engine} cannot simulate `{part}`: it has no {lacking}; use --engine direct"
    )]
    Lacking {
        /// Name and version of the engine.
        engine: String,
        /// Body or joint of the scene.
        part: String,
        /// What is needed.
        lacking: &'static str,
    },
    /// It has all that is needed, but not for these numbers.
    #[error("the engine {engine} refuses these bodies: {reason}; use --engine direct")]
    Refused {
        /// Name and version of the engine.
        engine: String,
        /// In its own words.
        reason: String,
    },
}

/// What an engine without [`crate::scene::Torsion::Patch`] lacks.
const PRESSED_PATCH: &str = "torsional friction of a pressed patch";

/// Refuses springs that couple axes, masses that depend on the direction, and pressed patches.
fn refuse_coupling(engine: &dyn Engine, scene: &Scene) -> Result<(), Unsupported> {
    let refuse = |part: &str, lacking| {
        Err(Unsupported::Lacking { engine: engine.version(), part: part.to_owned(), lacking })
    };
    let coupled = |joint: &&Joint| matches!(joint.springs, Springs::Coupled(_));
    if let Some(joint) = scene.joints.iter().find(coupled) {
        return refuse(&joint.name, "springs that couple the axes of a joint");
    }
    if let Some(pair) = scene.patched() {
        return refuse(&scene.bodies[pair.first.0].name, PRESSED_PATCH);
    }
    let mechanism = |body: &&Body| matches!(body.motion, Motion::Mechanism(_));
    match scene.bodies.iter().find(mechanism) {
        Some(body) => refuse(&body.name, "mass that depends on the direction"),
        None => Ok(()),
    }
}

/// The state left the finite numbers; the trial says nothing.
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

/// A point at which two bodies press on one another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Where, m.
    pub point: Point3<f64>,
    /// Force on the second body over the last step, with friction, N.
    pub force: Vector3<f64>,
}

impl ContactPoint {
    /// The same seen from another frame.
    pub fn seen(&self, from: &Pose) -> Self {
        ContactPoint { point: from * self.point, force: from * self.force }
    }
}

/// A scene that is being simulated.
pub trait World: Send + Sync {
    /// Advances by one step; every step is checked for divergence.
    fn step(&mut self) -> Result<(), Diverged>;

    /// Length of one step, s.
    fn step_s(&self) -> f64;

    /// Body frame in the world.
    fn pose(&self, body: BodyId) -> Pose;

    /// Commands where a driven body is at the end of the next step.
    fn drive(&mut self, body: BodyId, pose: Pose);

    /// Puts a fixed body elsewhere; it must touch nothing before and after.
    fn place(&mut self, body: BodyId, pose: Pose);

    /// Replaces the spring of a sprung axis (0..6) of a joint.
    fn set_spring(&mut self, joint: JointId, axis: usize, spring: Spring);

    /// Applies a force at a free body's centre of mass, N, and a moment, N m, in
    /// world axes, in every step from now on; replaces what was applied before.
    fn push(&mut self, body: BodyId, force: Vector3<f64>, moment: Vector3<f64>);

    /// Contact between two bodies over the last step.
    fn contact(&self, first: BodyId, second: BodyId) -> ContactForce;

    /// The points at which two bodies press on one another, for pictures; none if the engine does
    /// not tell.
    fn contact_points(&self, _first: BodyId, _second: BodyId) -> Vec<ContactPoint> {
        Vec::new()
    }

    /// An independent copy that continues bit for bit alike.
    fn snapshot(&self) -> Box<dyn World>;
}
