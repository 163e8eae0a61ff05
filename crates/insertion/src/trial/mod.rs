//! Trial: one simulated insertion attempt.

use crate::{Finger, Outcome};
use contact::ContactPoint;
use contact::scene::Pose;
use input::units::MM;
use nalgebra::Vector3;
use serde::Serialize;
use std::sync::atomic::AtomicBool;

mod attempt;
pub mod cell;
mod classify;
mod conditions;
pub mod engine;
mod monitor;
mod motion;
pub mod picture;
pub mod record;
pub mod run;

pub use attempt::commanded::{PROBE_FORCE, PROBE_SLIDES, PROBE_SPEED, PROBE_STROKE, Trajectory};
pub use attempt::driven::{Driven, State};
pub use conditions::Conditions;
pub use motion::Tcp;
pub use record::{LOG_STEP_S, Recording, Sample};

/// State at the end of one phase of a trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhaseEnd {
    /// Phase name as in the task file.
    pub name: String,
    /// Simulated time since the trial began, s.
    pub time_s: f64,
    /// Tip of the plug in the task frame (x, y, z), mm.
    pub tip_mm: [f64; 3],
    /// Angle between the plug's axis and z, degrees.
    pub tilt_deg: f64,
    /// Slip of the part in the grasp since the grasp, mm.
    pub slip_mm: f64,
    /// Largest contact force between plug and socket during the phase, N.
    pub peak_force_n: f64,
    /// Poses of the bodies, task frame, m; for pictures.
    #[serde(skip)]
    pub poses: Poses,
    /// Contact points of the socket on the plug, task frame; for pictures.
    #[serde(skip)]
    pub contacts: Vec<ContactPoint>,
}

impl PhaseEnd {
    /// Transforms tip and poses; no body touches the socket yet.
    fn transform(&mut self, by: &Pose) {
        let tip = by.rotation * Vector3::from(self.tip_mm) + by.translation.vector / MM;
        self.tip_mm = tip.into();
        let Poses { plug, latch, fingers } = &mut self.poses;
        for pose in [plug].into_iter().chain(latch).chain(fingers) {
            *pose = by * *pose;
        }
    }
}

/// Poses of plug and fingers, task frame, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Poses {
    /// Plug without its latch.
    pub plug: Pose,
    /// Latch of the plug, if it has one.
    pub latch: Option<Pose>,
    /// The finger at -y and the finger at +y.
    pub fingers: [Pose; 2],
}

/// Result of one trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Outcome of the trial.
    pub outcome: Outcome,
    /// Margin, -1 to 1: the smallest excess over a success criterion, as a share of that criterion;
    /// below 0 if the trial failed, 0 if it diverged.
    pub margin: f64,
    /// Depth of the plug's tip below the socket's top at the end, mm.
    pub depth_mm: f64,
    /// Angle between the plug's axis and z at the end, degrees.
    pub tilt_deg: f64,
    /// Largest contact force between plug and socket, N.
    pub peak_force_n: f64,
    /// Slip of the part in the grasp since the grasp, at the end, mm.
    pub slip_mm: f64,
    /// Whether the robot ended the trial by a protective stop.
    pub robot_stopped: bool,
    /// State at the end of each phase that was begun.
    pub phases: Vec<PhaseEnd>,
    /// Simulated time of the trial, s.
    pub simulated_s: f64,
    /// Whether the trial diverged at first and was repeated at half the step.
    pub retried: bool,
}

/// Stop flag that is never set.
pub static NEVER: AtomicBool = AtomicBool::new(false);

/// Fingers and conditions of a grasp.
#[derive(Debug, Clone, Copy)]
pub struct Grasp<'a> {
    /// Model of both fingers.
    pub finger: Finger,
    /// Deviations from the task file.
    pub conditions: Conditions,
    /// Stop flag: if set, grasp and trials end at once with an invalid result.
    pub stop: &'a AtomicBool,
}

impl Grasp<'static> {
    /// Returns a grasp by these fingers under the conditions of the task file, without a stop flag.
    pub fn of(finger: &Finger) -> Self {
        Grasp { finger: *finger, conditions: Conditions::NOMINAL, stop: &NEVER }
    }
}

/// A trial and its samples.
pub type Followed = (Trial, Vec<Sample>);

/// Setup in which trials are run: one task, one robot, one engine.
pub trait Rig: Send + Sync {
    /// Grasps the part, once for all offsets.
    fn grasp<'a>(&'a self, grasp: Grasp<'a>) -> Box<dyn Grasped + 'a>;

    /// Returns the trial of a grasp, its start shifted by `offset` metres along y, with its
    /// frames; `None` if the rig does not simulate.
    fn record(&self, _grasp: Grasp<'_>, _offset: f64) -> Option<Recording> {
        None
    }

    /// Returns the trials along commanded trajectories (task frame) from the same grasp, in place of the strategy, with
    /// the samples that a robot logs; empty if the rig does not simulate.
    fn follow(&self, _grasp: Grasp<'_>, _each: &[&Trajectory]) -> Vec<Followed> {
        Vec::new()
    }

    /// Returns the trial of a friction probe on a flat plate that replaces the socket, with its top at z = 0, with the
    /// samples that a robot logs; `None` if the rig does not simulate.
    fn probe(&self, _grasp: Grasp<'_>) -> Option<Followed> {
        None
    }

    /// Returns a trial of these fingers whose moves the caller commands; `None` if the rig does not simulate.
    fn driven(&self, _finger: &Finger) -> Option<Driven> {
        None
    }
}

/// Rest in which the robot zeroes its sensor, s: before a logged trial, and again at the beginning of its log.
const ZEROING_S: f64 = 0.2;

/// A part held and tilted, ready for a trial at any offset.
pub trait Grasped: Send + Sync {
    /// Runs a trial with the start shifted by `offset` metres along y. The robot rests twice for `rest_s` seconds
    /// before the search; samples are taken every `every_s` seconds from the second rest on.
    fn run(&self, offset: f64, every_s: Option<f64>, rest_s: f64) -> Followed;

    /// Returns the trial with the samples that a robot logs if it zeroes its sensor before the search.
    fn logged(&self, offset: f64) -> Followed {
        self.run(offset, Some(LOG_STEP_S), ZEROING_S)
    }

    /// Returns the trial alone.
    fn trial(&self, offset: f64) -> Trial {
        self.run(offset, None, 0.0).0
    }
}
