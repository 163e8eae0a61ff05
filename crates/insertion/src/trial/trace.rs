//! A trial as it went on: samples at even times.

use serde::Serialize;

/// Sample of a trial at one time: part, robot and force; task frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sample {
    /// Simulated time since the trial began, s.
    pub time_s: f64,
    /// Place of the phase among [`Trial::phases`](super::Trial::phases).
    pub phase: u32,
    /// Position of the TCP, mm.
    pub tcp_mm: [f64; 3],
    /// Tip of the plug, mm.
    pub tip_mm: [f64; 3],
    /// Angle between the plug's axis and z, degrees.
    pub tilt_deg: f64,
    /// Net contact force of the socket on the plug over the last step, N.
    pub force_n: [f64; 3],
    /// Slip of the part in the grasp since the grasp, mm.
    pub slip_mm: f64,
}

/// Samples taken on the way.
#[derive(Debug, Clone)]
pub(super) struct Trace {
    every_s: f64,
    next_s: f64,
    pub samples: Vec<Sample>,
}

impl Trace {
    /// A sample each `every_s` seconds of simulated time, or at each step if that is longer.
    pub fn new(every_s: f64) -> Self {
        Trace { every_s, next_s: 0.0, samples: Vec::new() }
    }

    /// Whether a sample is due after a step of `step_s` that ended at this time.
    pub fn due(&self, time_s: f64, step_s: f64) -> bool {
        time_s > self.next_s - 0.5 * step_s
    }

    /// Keeps a sample and sets the time of the next.
    pub fn take(&mut self, sample: Sample) {
        self.samples.push(sample);
        self.next_s = sample.time_s + self.every_s;
    }
}
