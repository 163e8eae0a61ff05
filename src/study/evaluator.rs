//! What a study measures a design with.

use super::cache::Cache;
use crate::evaluation::Evaluation;
use crate::evaluation::robustness::{self, Plan};
use crate::evaluation::template::{Impossible, Template};
use crate::evaluation::tolerance::Search;
use crate::finger::Finger;
use crate::input::space::Design;
use crate::input::task::Task;
use crate::outcome::Outcome;
use crate::surrogate::Prediction;
use crate::trial::run::RigError;
use crate::trial::{Conditions, Grasped, Rig, Trial};
use std::sync::atomic::{AtomicBool, Ordering};

/// What is known of one design after its evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Stiffness predicted for it.
    pub stiffness: Prediction,
    /// What the simulation of a finger of that stiffness measured, on the first task.
    pub evaluation: Evaluation,
    /// The same on the other tasks, in their order.
    pub other_tasks: Vec<Evaluation>,
}

/// Evaluates designs, several at a time.
pub trait Evaluate: Sync {
    /// Measures one design; equal designs measure equal.
    ///
    /// # Errors
    /// If the design cannot be simulated.
    fn evaluate(&self, design: &Design) -> Result<Measured, Impossible>;
}

/// Surrogate, task and finger, and window search, one after the other.
pub struct Simulated<'a, P, R> {
    /// Predicts a design's stiffness.
    pub predict: P,
    /// Puts what else a design sets into task and finger.
    pub template: &'a Template,
    /// The same for the tasks beside the first.
    pub other_templates: &'a [Template],
    /// What is measured beside the window.
    pub plan: &'a Plan,
    /// Makes the place where trials of a task are run.
    pub rig: R,
    /// Set when the study is to stop: trials then end at once.
    pub stop: &'a AtomicBool,
    /// Where evaluations are kept, if they are.
    pub cache: Option<&'a Cache>,
}

impl<P, R> Evaluate for Simulated<'_, P, R>
where
    P: Fn(&Design) -> Prediction + Sync,
    R: Fn(&Task) -> Result<Box<dyn Rig>, RigError> + Sync,
{
    fn evaluate(&self, design: &Design) -> Result<Measured, Impossible> {
        let stiffness = (self.predict)(design);
        let on = |template| self.on_task(template, design, &stiffness);
        let evaluation = on(self.template)?;
        let other_tasks = self.other_templates.iter().map(on).collect::<Result<_, _>>()?;
        Ok(Measured { stiffness, evaluation, other_tasks })
    }
}

impl<P, R> Simulated<'_, P, R>
where
    R: Fn(&Task) -> Result<Box<dyn Rig>, RigError>,
{
    fn on_task(
        &self,
        template: &Template,
        design: &Design,
        stiffness: &Prediction,
    ) -> Result<Evaluation, Impossible> {
        let finger = Finger::new(stiffness.compliance.mean, stiffness.assembly.mean);
        let (task, finger) = template.apply(design, finger)?;
        let (search, plan) = (Search::default(), self.plan);
        let inputs = (stiffness, &task, finger, search, plan);
        let keep = self.cache.map(|cache| (cache, cache.key(&inputs)));
        if let Some(found) = keep.as_ref().and_then(|(cache, key)| cache.get(key)) {
            return Ok(found);
        }
        let rig = (self.rig)(&task)?;
        let rig = Stoppable { rig: &*rig, stop: self.stop };
        let evaluation = robustness::evaluate(&rig, &finger, stiffness, search, plan);
        // Once it is set trials may have been skipped.
        if let Some((cache, key)) = keep.filter(|_| !self.stop.load(Ordering::SeqCst)) {
            cache.put(&key, &evaluation, stiffness);
        }
        Ok(evaluation)
    }
}

/// A rig whose trials end at once when the study is to stop. What they then
/// report is worthless; the runner throws such evaluations away.
struct Stoppable<'a> {
    rig: &'a dyn Rig,
    stop: &'a AtomicBool,
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
