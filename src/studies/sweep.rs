//! Windows of many fingers on one task.

use crate::commands::evaluate::{Evaluated, Request as EvaluateRequest};
use crate::{Failure, FingerRequest, RunRequest, Setup, not_stopped};
use insertion::{Plan, Search};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use study::{Cache, CachedEvaluator};

/// Evaluator of fingers on a task, with its own threads and the cache of the studies.
pub struct Sweep {
    setup: Setup,
    search: Search,
    plan: Plan,
    cache: Option<Cache>,
    pool: ThreadPool,
}

impl Sweep {
    /// Returns the evaluator for a request; its finger and its repeats are ignored.
    ///
    /// # Errors
    /// If the request is invalid.
    pub fn new(windows: &EvaluateRequest, run: &RunRequest) -> Result<Self, Failure> {
        let (setup, plan) = windows.prepared()?;
        setup.only_task()?;
        let (cache, pool) = (run.cache(&setup), run.pool()?);
        Ok(Sweep { setup, search: windows.search(), plan, cache, pool })
    }

    /// Simulates the tolerance windows of fingers.
    ///
    /// # Errors
    /// The error of the first finger that cannot be simulated; if `stop` is set meanwhile.
    pub fn measure(
        &self,
        fingers: &[FingerRequest],
        stop: &AtomicBool,
    ) -> Result<Vec<Evaluated>, Failure> {
        let Sweep { setup, search, plan, .. } = self;
        let (evaluator, cache) = (&setup.evaluator, self.cache.as_ref());
        let evaluator = CachedEvaluator { evaluator, search: *search, plan, cache, stop };
        let one = |finger: &FingerRequest| {
            not_stopped(stop)?;
            let clock = Instant::now();
            // Values of a sweep are computed: small ones are meant.
            let chosen = finger.choose_with(setup, &setup.evaluator)?;
            let (evaluation, _) = evaluator.evaluate_scenario(&chosen.scenario, plan)?;
            let wall_s = clock.elapsed().as_secs_f64();
            let (shorter_push, bands, computed, measured) = (None, None, None, Vec::new());
            Ok(Evaluated { chosen, evaluation, shorter_push, bands, computed, wall_s, measured })
        };
        let found: Vec<_> = self.pool.install(|| fingers.par_iter().map(one).collect());
        not_stopped(stop)?;
        found.into_iter().collect()
    }
}
