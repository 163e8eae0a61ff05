//! Simulation of tolerance windows at given values of the unmeasured parameters.

use input::units::MM;
use insertion::evaluation::Evaluation;
use insertion::evaluation::evaluator::{Evaluator, Specimen};
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::template::{DesignError, Template};
use insertion::evaluation::tolerance::{self, Search};
use insertion::outcome::Outcome;
use insertion::space::Design;
use insertion::trial::Grasp;
use parameters::Parameter;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use study::Cache;

/// Shifts of the start, mm, tried in turn if the trial from the task's start does not insert: an operator would teach a
/// start that does.
const SHIFTS_MM: [f64; 4] = [1.0, -1.0, 2.0, -2.0];

/// Simulation of one task as a function of some of its parameters.
pub struct Simulation<'a> {
    pub(super) evaluator: &'a Evaluator,
    pub(super) template: &'a Template,
    /// Parameters that are varied, in the given order.
    pub parameters: Vec<&'a Parameter>,
    /// Folder of the cache, if windows are cached.
    cache: Option<PathBuf>,
    /// Cancellation flag; once it is set, windows are invalid and not cached.
    pub stop: &'a AtomicBool,
}

impl<'a> Simulation<'a> {
    /// Creates a simulation; parameters that neither the task nor the robot has are dropped.
    pub fn new(
        evaluator: &'a Evaluator,
        template: &'a Template,
        parameters: impl Iterator<Item = &'a Parameter>,
        cache: Option<PathBuf>,
        stop: &'a AtomicBool,
    ) -> Self {
        let parameters = parameters.filter(|one| evaluator.has(template, one)).collect();
        Simulation { evaluator, template, parameters, cache, stop }
    }

    /// Simulates the window of a design at `shares`, the levels of the quantiles of the parameters' priors (0 to 1); if
    /// they are empty, with the values of the input files.
    pub fn window(&self, design: &Design, shares: &[f64]) -> Result<Evaluation, DesignError> {
        let values = self.parameters.iter().zip(shares).map(|(p, &share)| (*p, p.at(share)));
        let values: Vec<_> = values.collect();
        let specimen = self.evaluator.apply(self.template, (design, None), &values)?;
        let inserts = |found: &Evaluation| found.window.nominal == Outcome::Inserted;
        let own = self.measure(&specimen)?;
        if inserts(&own) {
            return Ok(own);
        }
        for shift in SHIFTS_MM {
            let mut specimen = specimen.clone();
            specimen.task.strategy.start[1] += shift * MM;
            let evaluation = self.measure(&specimen)?;
            if inserts(&evaluation) {
                return Ok(evaluation);
            }
        }
        Ok(own)
    }

    /// Simulates the window of a specimen, or returns the cached one.
    fn measure(&self, specimen: &Specimen) -> Result<Evaluation, DesignError> {
        let engine = self.evaluator.engine;
        let new = |dir: &PathBuf| Cache::new(dir, &specimen.robot, &engine.record());
        let cache = self.cache.as_ref().map(new);
        let search = Search::default();
        let keep =
            cache.as_ref().map(|cache| (cache, cache.key(&(specimen, search, &Plan::WINDOW))));
        if let Some(found) = keep.as_ref().and_then(|(cache, key)| cache.get(key)) {
            return Ok(found);
        }
        let rig = self.evaluator.rig(specimen, None, 1.0)?;
        let grasp = Grasp { stop: self.stop, ..Grasp::of(&specimen.finger) };
        let evaluation = tolerance::evaluate_grasp(&*rig, grasp, search);
        if let Some((cache, key)) = keep
            && !self.stop.load(Ordering::SeqCst)
        {
            cache.put(&key, &evaluation);
        }
        Ok(evaluation)
    }
}
