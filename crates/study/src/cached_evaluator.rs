//! Evaluation of a study's designs by simulation, with a cache and cancellation.

use super::Cache;
use insertion::{
    Design, DesignError, Evaluate, Evaluation, Evaluations, Evaluator, Plan, Race, Scenario, Search,
};
use std::sync::atomic::{AtomicBool, Ordering};

/// Evaluator with a cache and cancellation.
pub struct CachedEvaluator<'a> {
    /// Evaluator without a cache.
    pub evaluator: &'a Evaluator,
    /// Method of the search for the ends of a window.
    pub search: Search,
    /// Plan of the trials under drawn errors.
    pub plan: &'a Plan,
    /// Cache, if there is one.
    pub cache: Option<&'a Cache>,
    /// Cancels the evaluation once it is set: trials then end at once.
    pub stop: &'a AtomicBool,
}

// The key of a cache entry includes the plan with its race. The cache therefore returns a raced evaluation only
// in the same race, and does not change the journal.
impl Evaluate for CachedEvaluator<'_> {
    fn evaluate(&self, design: &Design, race: Option<&Race>) -> Result<Evaluations, DesignError> {
        let (plan, mut cached) = (self.plan.against(race), Vec::new());
        let evaluations = self.evaluator.evaluate_by(design, |scenario| {
            let (evaluation, was_cached) = self.evaluate_scenario(scenario, &plan)?;
            cached.push(was_cached);
            Ok(evaluation)
        })?;
        Ok(Evaluations { cached, ..evaluations })
    }
}

impl CachedEvaluator<'_> {
    /// Returns the evaluations of a design if those on all tasks are in the cache.
    pub fn cached(&self, design: &Design, race: Option<&Race>) -> Option<Evaluations> {
        let (cache, plan) = (self.cache?, self.plan.against(race));
        let stiffness = self.evaluator.predict(design).ok()?;
        let on = |template| {
            let scenario = self.evaluator.scenario(template, design, stiffness).ok()?;
            cache.get(&self.key(cache, &scenario, &plan))
        };
        let tasks: Vec<_> = self.evaluator.templates.iter().map(on).collect::<Option<_>>()?;
        let cached = vec![true; tasks.len()];
        Some(Evaluations { stiffness, tasks, cached })
    }

    /// Stores the evaluations by a worker in the cache.
    pub fn store(&self, design: &Design, race: Option<&Race>, evaluations: &Evaluations) {
        let Some(cache) = self.cache else { return };
        let plan = self.plan.against(race);
        for (template, evaluation) in self.evaluator.templates.iter().zip(&evaluations.tasks) {
            if let Ok(scenario) = self.evaluator.scenario(template, design, evaluations.stiffness) {
                cache.put(&self.key(cache, &scenario, &plan), evaluation);
            }
        }
    }

    /// Returns the key of a scenario (task, finger and robot of a design) in the cache.
    fn key(&self, cache: &Cache, scenario: &Scenario, plan: &Plan) -> String {
        cache.key(&(scenario, self.search, plan))
    }

    /// Evaluates a scenario; returns the evaluation, and whether it was in the cache.
    ///
    /// # Errors
    /// If the design cannot be simulated.
    pub fn evaluate_scenario(
        &self,
        scenario: &Scenario,
        plan: &Plan,
    ) -> Result<(Evaluation, bool), DesignError> {
        let entry = self.cache.map(|cache| (cache, self.key(cache, scenario, plan)));
        if let Some(found) = entry.as_ref().and_then(|(cache, key)| cache.get(key)) {
            return Ok((found, true));
        }
        let evaluation = self.evaluator.simulate(scenario, self.search, plan, self.stop)?;
        // A cancelled evaluation may lack trials.
        if let Some((cache, key)) = entry.filter(|_| !self.stop.load(Ordering::SeqCst)) {
            cache.put(&key, &evaluation);
        }
        Ok((evaluation, false))
    }
}
