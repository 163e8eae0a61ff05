//! Measurement of a study's designs: the evaluator, a cache, and a flag that stops it.

use super::cache::Cache;
use insertion::evaluation::Evaluation;
use insertion::evaluation::evaluator::{Evaluate, Evaluator, Measured, Specimen};
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::robustness::race::Race;
use insertion::evaluation::template::Impossible;
use insertion::evaluation::tolerance::Search;
use insertion::space::Design;
use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};

/// Measures designs by simulation, or finds them in the cache.
pub struct Simulated<'a> {
    pub evaluator: &'a Evaluator,
    /// How the ends of a window are looked for.
    pub search: Search,
    /// Plan of the measurements beside the window.
    pub plan: &'a Plan,
    /// Where evaluations are kept, if they are.
    pub cache: Option<&'a Cache>,
    /// Set when the study is to stop: trials then end at once.
    pub stop: &'a AtomicBool,
}

impl Evaluate for Simulated<'_> {
    fn evaluate(&self, design: &Design) -> Result<Measured, Impossible> {
        self.evaluate_by(design, self.plan)
    }

    fn race(&self, design: &Design, race: &Race) -> Result<Measured, Impossible> {
        self.evaluate_by(design, &self.plan.against(Some(race)))
    }
}

// The plan with its race is part of what names an entry of the cache. So a raced evaluation is found by
// the same race only, a full one by none, and what the cache holds changes no journal.
impl Simulated<'_> {
    fn evaluate_by(&self, design: &Design, plan: &Plan) -> Result<Measured, Impossible> {
        // The tasks come one after the other.
        let cached = RefCell::new(Vec::new());
        let measured = self.evaluator.evaluate_by(design, |specimen| {
            let (evaluation, known) = self.measure(specimen, plan)?;
            cached.borrow_mut().push(known);
            Ok(evaluation)
        })?;
        Ok(Measured { cached: cached.into_inner(), ..measured })
    }

    /// Cached measurements of a design; `None` unless they are complete. Nothing is simulated.
    pub fn known(&self, design: &Design, race: Option<&Race>) -> Option<Measured> {
        let (cache, plan) = (self.cache?, self.plan.against(race));
        let stiffness = self.evaluator.predict(design).ok()?;
        let on = |template| {
            let specimen = self.evaluator.specimen(template, design, stiffness).ok()?;
            cache.get(&self.key(cache, &specimen, &plan))
        };
        let tasks: Vec<_> = self.evaluator.templates.iter().map(on).collect::<Option<_>>()?;
        let cached = vec![true; tasks.len()];
        Some(Measured { stiffness, tasks, cached })
    }

    /// Keeps in the cache what was measured of a design elsewhere.
    pub fn keep(&self, design: &Design, race: Option<&Race>, measured: &Measured) {
        let Some(cache) = self.cache else { return };
        let plan = self.plan.against(race);
        for (template, evaluation) in self.evaluator.templates.iter().zip(&measured.tasks) {
            if let Ok(specimen) = self.evaluator.specimen(template, design, measured.stiffness) {
                cache.put(&self.key(cache, &specimen, &plan), evaluation);
            }
        }
    }

    fn key(&self, cache: &Cache, specimen: &Specimen, plan: &Plan) -> String {
        cache.key(&(specimen, self.search, plan))
    }

    /// The evaluation, and whether it was in the cache.
    pub fn measure(
        &self,
        specimen: &Specimen,
        plan: &Plan,
    ) -> Result<(Evaluation, bool), Impossible> {
        let keep = self.cache.map(|cache| (cache, self.key(cache, specimen, plan)));
        if let Some(found) = keep.as_ref().and_then(|(cache, key)| cache.get(key)) {
            return Ok((found, true));
        }
        let evaluation = self.evaluator.measure(specimen, self.search, plan, self.stop)?;
        // Once it is set trials may have been skipped.
        if let Some((cache, key)) = keep.filter(|_| !self.stop.load(Ordering::SeqCst)) {
            cache.put(&key, &evaluation);
        }
        Ok((evaluation, false))
    }
}
