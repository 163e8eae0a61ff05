//! What a study measures a design with.

use crate::evaluation::{Evaluation, Outcome};
use crate::finger::Finger;
use crate::space::Design;
use crate::surrogate::Prediction;
use crate::tolerance::{self, Search};
use crate::trial::{Conditions, Grasped, Rig, Trial};
use std::sync::atomic::{AtomicBool, Ordering};

/// What is known of one design after its evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Stiffness predicted for it.
    pub stiffness: Prediction,
    /// What the simulation of a finger of that stiffness measured.
    pub evaluation: Evaluation,
}

/// Evaluates designs, several at a time.
pub trait Evaluate: Sync {
    /// Measures one design; equal designs measure equal.
    fn evaluate(&self, design: &Design) -> Measured;
}

/// Surrogate, finger and window search, one after the other.
pub struct Simulated<'a, P> {
    /// Predicts a design's stiffness.
    pub predict: P,
    /// Where trials are run.
    pub rig: &'a dyn Rig,
}

impl<P: Fn(&Design) -> Prediction + Sync> Evaluate for Simulated<'_, P> {
    fn evaluate(&self, design: &Design) -> Measured {
        let stiffness = (self.predict)(design);
        let finger = Finger::new(stiffness.compliance.mean, stiffness.assembly.mean);
        Measured {
            stiffness,
            evaluation: tolerance::evaluate(self.rig, &finger, Search::default()),
        }
    }
}

/// A rig whose trials end at once when the study is to stop. What they then
/// report is worthless; the runner throws such evaluations away.
pub struct Stoppable<'a> {
    /// The rig that does the work.
    pub rig: &'a dyn Rig,
    /// Set when the study is to stop.
    pub stop: &'a AtomicBool,
}

impl Rig for Stoppable<'_> {
    fn grasp_in(&self, finger: &Finger, conditions: &Conditions) -> Box<dyn Grasped + '_> {
        if self.stop.load(Ordering::SeqCst) {
            return Box::new(Stopped);
        }
        let grasped = self.rig.grasp_in(finger, conditions);
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
            depth_mm: f64::NAN,
            tilt_deg: f64::NAN,
            peak_force_n: f64::NAN,
            slip_mm: f64::NAN,
            phases: Vec::new(),
            simulated_s: 0.0,
        }
    }
}
