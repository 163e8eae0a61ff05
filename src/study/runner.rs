//! Runs a study on the threads of this process; how it goes on is decided by its
//! [`Course`].

use super::course::{Arrived, Course, Ending, Next, Wanted};
use super::error::StudyError;
use super::folder::Study;
use super::record::{Recorded, Timing};
use super::time;
use ask_tell::Optimizer;
use insertion::evaluation::evaluator::Evaluate;
use rayon::ThreadPool;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Instant;

/// What a run works with.
pub struct Runner<'a> {
    /// Measures designs. It should end early once `stop` is set.
    pub evaluator: &'a dyn Evaluate,
    /// Does the measuring; the calling thread, outside of it, proposes and writes.
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
                                scope.spawn(move |_| drop(sender.send(self.measure(&wanted))));
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
                    && let Some(arrived) = result?
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
        let Wanted { proposal, design } = wanted;
        if self.stop.load(Ordering::SeqCst) {
            return Ok(None);
        }
        let (datetime_start, clock) = (time::now(), Instant::now());
        let measured = self.evaluator.evaluate(design);
        // Once it is set the evaluator may have skipped trials.
        if self.stop.load(Ordering::SeqCst) {
            return Ok(None);
        }
        let mut measured = measured.map_err(|source| StudyError::Impossible {
            index: *proposal,
            design: design.to_string(),
            source,
        })?;
        let timing = Timing {
            datetime_start,
            datetime_complete: time::now(),
            wall_s: clock.elapsed().as_secs_f64(),
            cached: std::mem::take(&mut measured.cached),
        };
        Ok(Some(Arrived { proposal: *proposal, measured, timing }))
    }
}
