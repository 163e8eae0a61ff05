//! Trials that end at once when a study is to stop.

use crate::outcome::Outcome;
use crate::trial::{Grasp, Grasped, Rig, Trial};
use std::sync::atomic::{AtomicBool, Ordering};

/// A rig, or a grasped part, whose trials end at once when the study is to stop. What they then
/// report is worthless; the runner throws such evaluations away.
pub struct Stoppable<'a, T> {
    /// Rig or grasped part; `None` of a part whose grasp began after the stop.
    pub inner: T,
    /// Set when they are to end.
    pub stop: &'a AtomicBool,
}

impl Rig for Stoppable<'_, &dyn Rig> {
    /// Watches its own flag in place of that of the grasp.
    fn hold<'a>(&'a self, grasp: Grasp<'a>) -> Box<dyn Grasped + 'a> {
        let held = || self.inner.hold(Grasp { stop: self.stop, ..grasp });
        let held = (!self.stop.load(Ordering::SeqCst)).then(held);
        Box::new(Stoppable { inner: held, stop: self.stop })
    }
}

impl Grasped for Stoppable<'_, Option<Box<dyn Grasped + '_>>> {
    fn trial(&self, offset: f64) -> Trial {
        match &self.inner {
            Some(held) if !self.stop.load(Ordering::SeqCst) => held.trial(offset),
            _ => Trial {
                outcome: Outcome::Diverged,
                margin: 0.0,
                depth_mm: f64::NAN,
                tilt_deg: f64::NAN,
                peak_force_n: f64::NAN,
                slip_mm: f64::NAN,
                phases: Vec::new(),
                simulated_s: 0.0,
                retried: false,
            },
        }
    }
}
