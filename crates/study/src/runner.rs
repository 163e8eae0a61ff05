//! Runs a study on the threads of this process; how it goes on is decided by its
//! [`Course`].

use super::course::{Arrived, Course, Ending, Next, Wanted};
use super::error::StudyError;
use super::folder::Study;
use super::record::{Recorded, Timing};
use ask_tell::Optimizer;
use insertion::evaluation::evaluator::Evaluate;
use rayon::ThreadPool;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

/// Resources of a run.
pub struct Runner<'a> {
    /// Measures designs. It should end early once `stop` is set.
    pub evaluator: &'a dyn Evaluate,
    /// Does the measuring; the calling thread, outside of it, proposes and writes.
    pub pool: &'a ThreadPool,
    /// Set (by Ctrl-C) when the run is to stop soon; also set by the runner
    /// itself after an error.
    pub stop: &'a AtomicBool,
    /// Whether no gain is expected after so many evaluations, of a study that settles.
    pub judge: &'a Judge<'a>,
}

/// Judges a study after so many of its evaluations.
pub type Judge<'a> = dyn Fn(&Study, usize) -> Result<bool, StudyError> + Sync + 'a;

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
        let mut course = Course::new(study);
        let (sender, receiver) = mpsc::channel();
        self.pool.in_place_scope(|scope| {
            let mut running = 0_usize;
            let mut step = || -> Result<Option<Ending>, StudyError> {
                if !self.stop.load(Ordering::SeqCst) {
                    match course.next(study, optimizer)? {
                        Next::Ended(ending) => return Ok(Some(ending)),
                        Next::Measure(wanted) => {
                            running += wanted.len();
                            for wanted in wanted {
                                let sender = sender.clone();
                                // The receiver is there until the scope ends.
                                scope.spawn(move |_| {
                                    // Whoever waits for it must learn of a panic.
                                    let measure = AssertUnwindSafe(|| self.measure(&wanted));
                                    drop(sender.send(catch_unwind(measure)));
                                });
                            }
                            return Ok(None);
                        }
                        Next::Judge(told) => {
                            let calm = (self.judge)(study, told)?;
                            // Interrupted, it says nothing.
                            if !self.stop.load(Ordering::SeqCst) {
                                course.judged(calm);
                            }
                            return Ok(None);
                        }
                        Next::Wait => {}
                    }
                }
                if running == 0 {
                    return Ok(Some(Ending::Interrupted));
                }
                running -= 1;
                // This end has a sender, so there is always one.
                if let Ok(result) = receiver.recv()
                    && let Some(arrived) = result.unwrap_or_else(|panic| {
                        self.stop.store(true, Ordering::SeqCst);
                        resume_unwind(panic)
                    })?
                {
                    course.take(study, arrived, progress)?;
                }
                Ok(None)
            };
            loop {
                match step() {
                    Ok(None) => {}
                    Ok(Some(ending)) => return Ok(ending),
                    Err(error) => {
                        self.stop.store(true, Ordering::SeqCst);
                        return Err(error);
                    }
                }
            }
        })
    }

    /// One measurement, `None` if the run was to stop before it was complete.
    fn measure(&self, wanted: &Wanted) -> Result<Option<Arrived>, StudyError> {
        let Wanted { proposal, design, race } = wanted;
        if self.stop.load(Ordering::SeqCst) {
            return Ok(None);
        }
        let (measured, timing) = Timing::of(|| match race {
            Some(race) => self.evaluator.race(design, race),
            None => self.evaluator.evaluate(design),
        });
        // Once it is set the evaluator may have skipped trials.
        if self.stop.load(Ordering::SeqCst) {
            return Ok(None);
        }
        let mut measured = measured.map_err(|source| StudyError::Impossible {
            index: *proposal,
            design: design.to_string(),
            source,
        })?;
        let timing = Timing { cached: std::mem::take(&mut measured.cached), ..timing };
        Ok(Some(Arrived { proposal: *proposal, measured, timing }))
    }
}
