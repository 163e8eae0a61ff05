//! Recording of a trial: samples at regular times, and frames of bodies and forces every millisecond for
//! replays. Recording does not change the trial: its result is bit-identical.

use super::classify::Placement;
use super::{Poses, Trial};
use crate::{FailureClass, Outcome, Stage};
use contact::ContactPoint;
use contact::scene::Pose;
use input::units::{DEG, MM};
use nalgebra::Vector3;
use serde::Serialize;

/// Interval of the samples that a robot logs, s: 500 Hz.
pub const LOG_STEP_S: f64 = 2e-3;
/// Interval of the frames, s.
const INTERVAL: f64 = 1e-3;

/// State of a trial at one time, for replays; task frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Simulated time since the trial began, s.
    pub time_s: f64,
    /// Stage of the trial.
    pub stage: Stage,
    /// Poses of plug and fingers, m.
    pub poses: Poses,
    /// Poses of the jaws, m: a finger without deflection has the pose of its jaw.
    pub jaws: [Pose; 2],
    /// Force of the socket on the plug, filtered like that of a wrist sensor (low-pass, 5 ms), N.
    pub force: Vector3<f64>,
    /// Slip of the part in the grasp since the grasp, m.
    pub slip: f64,
    /// Contact points of the socket on the plug.
    pub contacts: Vec<ContactPoint>,
    /// Contact points of the fingers on the plug.
    pub grips: Vec<ContactPoint>,
}

impl Frame {
    /// Returns the depth of the plug's tip below the socket's top, mm.
    pub fn depth_mm(&self) -> f64 {
        -self.poses.plug.translation.z / MM
    }

    /// Returns the angle between the plug's axis and z, degrees.
    pub fn tilt_deg(&self) -> f64 {
        Placement::new(&self.poses.plug).tilt / DEG
    }

    /// Transforms all poses, points and the force by a pose.
    pub(super) fn transform(&mut self, by: &Pose) {
        let poses = [&mut self.poses.plug].into_iter().chain(&mut self.poses.latch);
        for pose in poses.chain(&mut self.poses.fingers).chain(&mut self.jaws) {
            *pose = by * *pose;
        }
        for point in self.contacts.iter_mut().chain(&mut self.grips) {
            *point = point.transformed(by);
        }
        self.force = by * self.force;
    }
}

/// Trial with its frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Result of the trial.
    pub trial: Trial,
    /// Frames in order of time, about a millisecond apart.
    pub frames: Vec<Frame>,
    /// Time at which the outcome was decided, s: the start of the push if the plug missed, otherwise the end.
    pub decided_s: f64,
}

impl Recording {
    pub(super) fn new(trial: Trial, frames: Vec<Frame>) -> Self {
        let push = frames.iter().find(|frame| frame.stage == Stage::Assembly);
        let missed = trial.outcome == Outcome::Failed(FailureClass::PlugMissed);
        // Limited to the last frame, which may be before the last step.
        let end = frames.last().map_or(trial.simulated_s, |frame| frame.time_s);
        let decided_s = push.filter(|_| missed).map_or(end, |frame| frame.time_s);
        Recording { trial, frames, decided_s }
    }
}

/// Recorder of one frame per interval.
#[derive(Debug, Clone, Default)]
pub(super) struct Recorder {
    steps: usize,
    pub frames: Vec<Frame>,
}

impl Recorder {
    /// Counts a step of `step_s` seconds and returns whether to record the state at its end.
    pub fn is_due(&mut self, step_s: f64) -> bool {
        let every = ((INTERVAL / step_s).round() as usize).max(1);
        self.steps += 1;
        self.steps.is_multiple_of(every)
    }
}

/// Sample of a trial at one time: part, robot and force; task frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sample {
    /// Simulated time since the trial began, s.
    pub time_s: f64,
    /// Index of the phase in [`Trial::phases`](super::Trial::phases).
    pub phase: u32,
    /// Position of the TCP, mm.
    pub tcp_mm: [f64; 3],
    /// Tilt of the TCP about x, degrees.
    pub tcp_tilt_deg: f64,
    /// Commanded position of the TCP, mm.
    pub target_mm: [f64; 3],
    /// Force of the socket on the plug, filtered like that of a wrist sensor (low-pass, 5 ms), N.
    pub sensed_n: [f64; 3],
    /// Tip of the plug, mm.
    pub tip_mm: [f64; 3],
    /// Angle between the plug's axis and z, degrees.
    pub tilt_deg: f64,
    /// Net contact force of the socket on the plug over the last step, unfiltered, N.
    pub force_n: [f64; 3],
    /// Slip of the part in the grasp since the grasp, mm.
    pub slip_mm: f64,
}

impl Sample {
    /// Interpolates between two samples; the phase is that of the later one.
    fn between(before: &Sample, after: &Sample, share: f64) -> Sample {
        let number = |a: f64, b: f64| a + share * (b - a);
        let vector = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|i| number(a[i], b[i]));
        Sample {
            time_s: number(before.time_s, after.time_s),
            phase: after.phase,
            tcp_mm: vector(before.tcp_mm, after.tcp_mm),
            tcp_tilt_deg: number(before.tcp_tilt_deg, after.tcp_tilt_deg),
            target_mm: vector(before.target_mm, after.target_mm),
            sensed_n: vector(before.sensed_n, after.sensed_n),
            tip_mm: vector(before.tip_mm, after.tip_mm),
            tilt_deg: number(before.tilt_deg, after.tilt_deg),
            force_n: vector(before.force_n, after.force_n),
            slip_mm: number(before.slip_mm, after.slip_mm),
        }
    }
}

/// Smallest interval of samples, s: no engine has a shorter step.
const MIN_INTERVAL: f64 = 5e-5;
/// Largest difference between the end of a step and a sample time for which no interpolation is needed, s.
const SAME_TIME: f64 = 1e-9;

/// Samples at equal intervals, interpolated between the ends of steps.
#[derive(Debug, Clone)]
pub(super) struct Trace {
    every_s: f64,
    last: Option<Sample>,
    pub samples: Vec<Sample>,
}

impl Trace {
    /// Creates a trace with a sample every `every_s` seconds of simulated time, from the end of the first step on.
    pub fn new(every_s: f64) -> Self {
        Trace { every_s: every_s.max(MIN_INTERVAL), last: None, samples: Vec::new() }
    }

    /// Records the state at the end of a step.
    pub fn record(&mut self, now: Sample) {
        let Some(last) = self.last.replace(now) else {
            self.samples.push(now);
            return;
        };
        while let Some(before) = self.samples.last() {
            let next_s = before.time_s + self.every_s;
            if next_s > now.time_s + SAME_TIME {
                return;
            }
            let share = (next_s - last.time_s) / (now.time_s - last.time_s);
            let same = (now.time_s - next_s).abs() < SAME_TIME;
            self.samples.push(if same { now } else { Sample::between(&last, &now, share) });
        }
    }
}
