//! Trials that are run once, however often they are asked for.

use crate::evaluation::tolerance::offset;
use crate::evaluation::{OFFSET_STEP_MM, OffsetStep};
use crate::finger::Finger;
use crate::trial::{Conditions, Grasped, Rig, Trial};
use crate::units::MM;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// A grasped part with the trials that were made of it.
pub(super) struct Remembered<'a> {
    grasped: &'a dyn Grasped,
    trials: Mutex<BTreeMap<OffsetStep, Trial>>,
}

impl<'a> Remembered<'a> {
    /// Without trials yet.
    pub fn new(grasped: &'a dyn Grasped) -> Self {
        Remembered { grasped, trials: Mutex::default() }
    }

    /// The trial at an offset.
    pub fn at(&self, step: OffsetStep) -> Trial {
        let seen = || self.trials.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(trial) = seen().get(&step) {
            return trial.clone();
        }
        // Not under the lock: the other end is looked for at the same time.
        let trial = self.grasped.trial(offset(step));
        seen().insert(step, trial.clone());
        trial
    }
}

impl Rig for Remembered<'_> {
    /// The grasped part, whatever is asked for: a window asks for the one it is of.
    fn grasp_in(&self, _finger: &Finger, _conditions: &Conditions) -> Box<dyn Grasped + '_> {
        Box::new(Again(self))
    }
}

struct Again<'a>(&'a Remembered<'a>);

impl Grasped for Again<'_> {
    fn trial(&self, offset: f64) -> Trial {
        self.0.at((offset / (OFFSET_STEP_MM * MM)).round() as OffsetStep)
    }
}
