//! Runs a study: ask, evaluate, write down, tell.
//!
//! # What is guaranteed
//!
//! The journal is a function of the configuration without its budget; the
//! budget only says where it ends (or where a polish begins, and then it cannot be
//! raised). It does not depend on the number of
//! threads, nor on how often the study was interrupted or its budget raised:
//! 20 evaluations and then 20 more are the same as 40 at once. This holds because
//!
//! - the optimizer is always asked for whole batches and told whole batches; a
//!   budget that ends within a batch evaluates its first designs and tells nothing;
//! - a study that goes on starts its optimizer anew and repeats asks and tells
//!   with the values of the journal, so its state is what it would have been;
//!   what it proposes on the way must be what the journal holds;
//! - evaluations that end out of order wait in memory until all earlier ones are written.

use super::error::StudyError;
use super::fits;
use super::folder::Study;
use super::journal::Journal;
use super::record::{Recorded, Timing};
use super::time;
use crate::evaluation::evaluator::{Evaluate, Measured};
use crate::evaluation::objective::Goals;
use crate::input::space::{Design, GridPoint};
use crate::optimizer::{Observation, Optimizer, StopReason};
use rayon::ThreadPool;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Instant;

/// Why a run of a study ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// As many designs were evaluated as the budget allows.
    BudgetSpent,
    /// Every design of the space has been evaluated.
    SpaceExhausted,
    /// The polish has found what it can find.
    Converged,
    /// It was told to stop.
    Interrupted,
}

/// What a run works with.
pub struct Runner<'a> {
    /// Measures designs. It should end early once `stop` is set.
    pub evaluator: &'a dyn Evaluate,
    /// What is asked of a design.
    pub goals: &'a Goals,
    /// Does the measuring; the calling thread, outside of it, writes.
    pub pool: &'a ThreadPool,
    /// Set (by Ctrl-C) when the run is to stop soon; also set by the runner
    /// itself after an error.
    pub stop: &'a AtomicBool,
}

impl Runner<'_> {
    /// Runs the study until its budget is spent; `optimizer` is new, and
    /// `progress` sees each evaluation after it was written.
    ///
    /// # Errors
    /// If a design is impossible, or the journal cannot be written; what was measured is saved
    /// where somebody else has had a hand in that.
    pub fn run(
        &self,
        study: &mut Study,
        optimizer: &mut dyn Optimizer,
        progress: &mut dyn FnMut(&Recorded),
    ) -> Result<Ending, StudyError> {
        self.run_on(study, optimizer, progress).map_err(|error| study.rescue(error))
    }

    fn run_on(
        &self,
        study: &mut Study,
        optimizer: &mut dyn Optimizer,
        progress: &mut dyn FnMut(&Recorded),
    ) -> Result<Ending, StudyError> {
        let batch = usize::try_from(study.config.batch).unwrap_or(usize::MAX);
        let budget = usize::try_from(study.config.evaluations()).unwrap_or(usize::MAX);
        let mut begun = 0;
        while begun < budget {
            let points = optimizer.ask(batch);
            if points.is_empty() {
                return Ok(match optimizer.stop() {
                    Some(StopReason::Converged) => Ending::Converged,
                    Some(StopReason::GridExhausted) | None => Ending::SpaceExhausted,
                });
            }
            let designs: Vec<Design> =
                points.iter().map(|point| study.config.space.design(point)).collect();
            study.check_replay(begun, &designs)?;
            let wanted = designs.len().min(budget - begun);
            let known = study.evaluations.len().saturating_sub(begun).min(wanted);
            let first = begun + known;
            self.measure(study, first as u64, &designs[known..wanted], progress)?;
            if study.evaluations.len() < begun + wanted {
                return Ok(Ending::Interrupted);
            }
            if wanted < designs.len() {
                break;
            }
            let found = study.evaluations[begun..].iter();
            let told: Vec<Observation> = points
                .into_iter()
                .zip(found)
                .map(|(point, recorded)| self.observation(point, recorded))
                .collect();
            optimizer.tell(&told);
            begun += wanted;
        }
        Ok(Ending::BudgetSpent)
    }

    fn observation(&self, point: GridPoint, recorded: &Recorded) -> Observation {
        match recorded.score.as_ref().zip(self.goals.told(&recorded.tasks())) {
            None => Observation::new(point, None),
            Some((score, values)) => {
                Observation { point, values, violations: score.violations.clone() }
            }
        }
    }

    /// Evaluates designs in parallel and writes them down in their order,
    /// `first` being the index of the first one.
    fn measure(
        &self,
        study: &mut Study,
        first: u64,
        designs: &[Design],
        progress: &mut dyn FnMut(&Recorded),
    ) -> Result<(), StudyError> {
        let (sender, receiver) = mpsc::channel();
        let mut writer = InOrder {
            journal: &mut study.journal,
            evaluations: &mut study.evaluations,
            waiting: BTreeMap::new(),
            next: first,
        };
        self.pool.in_place_scope(|scope| {
            for (index, design) in (first..).zip(designs) {
                let sender = sender.clone();
                scope.spawn(move |_| {
                    if let Some(result) = self.evaluate(index, design).transpose() {
                        // The receiver is gone only after an error.
                        let _ = sender.send(result);
                    }
                });
            }
            drop(sender);
            for result in receiver {
                if let Err(error) = result.and_then(|recorded| writer.take(recorded, progress)) {
                    self.stop.store(true, Ordering::SeqCst);
                    return Err(error);
                }
            }
            Ok(())
        })
    }

    /// One evaluation, `None` if the run was to stop before it was complete.
    fn evaluate(&self, index: u64, design: &Design) -> Result<Option<Recorded>, StudyError> {
        if self.stop.load(Ordering::SeqCst) {
            return Ok(None);
        }
        let (datetime_start, clock) = (time::now(), Instant::now());
        let measured = self.evaluator.evaluate(design);
        // Once it is set the evaluator may have skipped trials.
        if self.stop.load(Ordering::SeqCst) {
            return Ok(None);
        }
        let Measured { stiffness, tasks, cached } = measured.map_err(|source| {
            StudyError::Impossible { index, design: design.to_string(), source }
        })?;
        let timing = Timing {
            datetime_start,
            datetime_complete: time::now(),
            wall_s: clock.elapsed().as_secs_f64(),
            cached,
        };
        let design = design.clone();
        let mut recorded = Recorded { index, design, score: None, stiffness, tasks, timing };
        // What is no number has failed.
        recorded.score = self.goals.score(&recorded.tasks()).filter(fits::sound);
        Ok(Some(recorded))
    }
}

/// Writes evaluations in the order of their indices, whatever order they come in.
struct InOrder<'a> {
    journal: &'a mut Journal,
    evaluations: &'a mut Vec<Recorded>,
    waiting: BTreeMap<u64, Recorded>,
    next: u64,
}

impl InOrder<'_> {
    fn take(
        &mut self,
        recorded: Recorded,
        progress: &mut dyn FnMut(&Recorded),
    ) -> Result<(), StudyError> {
        self.waiting.insert(recorded.index, recorded);
        while let Some(recorded) = self.waiting.remove(&self.next) {
            let written = self.journal.append(&recorded);
            if let Err(StudyError::Interfered { .. }) | Ok(()) = written {
                progress(&recorded);
                // What is not in the journal is saved with the rest.
                self.evaluations.push(recorded);
                self.next += 1;
            }
            written?;
        }
        Ok(())
    }
}

impl Study {
    /// Whether the journal, from index `begun` on, holds what is proposed now.
    fn check_replay(&self, begun: usize, proposed: &[Design]) -> Result<(), StudyError> {
        let found = self.evaluations.iter().skip(begun);
        match found.zip(proposed).find(|(found, proposed)| found.design != **proposed) {
            None => Ok(()),
            Some((found, proposed)) => Err(StudyError::Replay {
                path: self.journal.path().to_owned(),
                index: found.index,
                found: found.design.to_string(),
                proposed: proposed.to_string(),
            }),
        }
    }
}
