//! Measurement of a study's designs: the evaluator, a cache, and a flag that stops it.

use super::cache::Cache;
use insertion::evaluation::Evaluation;
use insertion::evaluation::evaluator::{Evaluate, Evaluator, Measured, Specimen};
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::template::Impossible;
use insertion::evaluation::tolerance::Search;
use insertion::space::Design;
use insertion::trial::run::RigError;
use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};

/// Measures designs by simulation, or finds them in the cache.
pub struct Simulated<'a> {
    /// Evaluator of designs.
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
        // The tasks come one after the other.
        let cached = RefCell::new(Vec::new());
        let measured = self.evaluator.evaluate_by(design, |specimen| {
            let (evaluation, known) = self.measure(specimen)?;
            cached.borrow_mut().push(known);
            Ok(evaluation)
        })?;
        Ok(Measured { cached: cached.into_inner(), ..measured })
    }
}

impl Simulated<'_> {
    /// Cached measurements of a design; `None` unless they are complete. Nothing is simulated.
    pub fn known(&self, design: &Design) -> Option<Measured> {
        let cache = self.cache?;
        let stiffness = self.evaluator.predict(design).ok()?;
        let on = |template| {
            let specimen = self.evaluator.specimen(template, design, stiffness).ok()?;
            cache.get(&self.key(cache, &specimen))
        };
        let tasks: Vec<_> = self.evaluator.templates.iter().map(on).collect::<Option<_>>()?;
        let cached = vec![true; tasks.len()];
        Some(Measured { stiffness, tasks, cached })
    }

    /// Keeps in the cache what was measured of a design elsewhere.
    pub fn keep(&self, design: &Design, measured: &Measured) {
        let Some(cache) = self.cache else { return };
        for (template, evaluation) in self.evaluator.templates.iter().zip(&measured.tasks) {
            if let Ok(specimen) = self.evaluator.specimen(template, design, measured.stiffness) {
                cache.put(&self.key(cache, &specimen), evaluation);
            }
        }
    }

    fn key(&self, cache: &Cache, specimen: &Specimen) -> String {
        cache.key(&(specimen, self.search, self.plan))
    }

    /// The evaluation, and whether it was in the cache.
    fn measure(&self, specimen: &Specimen) -> Result<(Evaluation, bool), RigError> {
        let keep = self.cache.map(|cache| (cache, self.key(cache, specimen)));
        if let Some(found) = keep.as_ref().and_then(|(cache, key)| cache.get(key)) {
            return Ok((found, true));
        }
        let evaluation = self.evaluator.measure(specimen, self.search, self.plan, self.stop)?;
        // Once it is set trials may have been skipped.
        if let Some((cache, key)) = keep.filter(|_| !self.stop.load(Ordering::SeqCst)) {
            cache.put(&key, &evaluation);
        }
        Ok((evaluation, false))
    }
}
