//! Trials that end at once when a study is to stop.

use crate::finger::Finger;
use crate::outcome::Outcome;
use crate::trial::{Conditions, Grasped, Rig, Trial};
use std::sync::atomic::{AtomicBool, Ordering};

/// A rig whose trials end at once when the study is to stop. What they then
/// report is worthless; the runner throws such evaluations away.
pub struct Stoppable<'a> {
    /// Where trials are run.
    pub rig: &'a dyn Rig,
    /// Set when they are to end.
    pub stop: &'a AtomicBool,
}

impl Rig for Stoppable<'_> {
    /// By its own flag; that of the call is for rigs that have none.
    fn grasp_until<'a>(
        &'a self,
        finger: &Finger,
        conditions: &Conditions,
        _stop: &'a AtomicBool,
    ) -> Box<dyn Grasped + 'a> {
        if self.stop.load(Ordering::SeqCst) {
            return Box::new(Stopped);
        }
        let grasped = self.rig.grasp_until(finger, conditions, self.stop);
        Box::new(StoppableGrasp { grasped, stop: self.stop })
    }
}

struct StoppableGrasp<'a> {
    grasped: Box<dyn Grasped + 'a>,
    stop: &'a AtomicBool,
}

impl Grasped for StoppableGrasp<'_> {
    fn trial(&self, offset: f64) -> Trial {
        if self.stop.load(Ordering::SeqCst) {
            return Stopped.trial(offset);
        }
        self.grasped.trial(offset)
    }
}

struct Stopped;

impl Grasped for Stopped {
    fn trial(&self, _offset: f64) -> Trial {
        Trial {
            outcome: Outcome::Diverged,
            margin: 0.0,
            depth_mm: f64::NAN,
            tilt_deg: f64::NAN,
            peak_force_n: f64::NAN,
            slip_mm: f64::NAN,
            phases: Vec::new(),
            simulated_s: 0.0,
            retried: false,
        }
    }
}
