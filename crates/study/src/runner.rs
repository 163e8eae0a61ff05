//! Execution of a study on the threads of this process.

use super::{
    Ending, Next, Proposal, ProposalResult, Recorded, Scheduler, Study, StudyError, Timing,
};
use ask_tell::Optimizer;
use insertion::Evaluate;
use rayon::ThreadPool;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

/// Executor of a study on the threads of this process.
pub struct Runner<'a> {
    /// Evaluator of designs; returns early once `stop` is set.
    pub evaluator: &'a dyn Evaluate,
    /// Threads that evaluate designs. The calling thread is not one of them; it runs the optimizer and writes
    /// the journal.
    pub pool: &'a ThreadPool,
    /// Cancels the run once it is set; also set by the runner after an error.
    pub stop: &'a AtomicBool,
}

impl Runner<'_> {
    /// Runs the study to its end with a new optimizer. `stagnates` returns whether no gain is expected, given a
    /// number of evaluations; `progress` is called for each evaluation written to the journal.
    ///
    /// # Errors
    /// If a design cannot be simulated or the journal cannot be written.
    pub fn run(
        &self,
        study: &mut Study,
        optimizer: &mut dyn Optimizer,
        stagnates: &mut dyn FnMut(&Study, usize) -> Result<bool, StudyError>,
        progress: &mut dyn FnMut(&Recorded),
    ) -> Result<Ending, StudyError> {
        let mut scheduler = Scheduler::new(study);
        let (sender, receiver) = mpsc::channel();
        let mut running = 0_usize;
        self.pool.in_place_scope(|scope| {
            let mut run = || -> Result<Ending, StudyError> {
                loop {
                    let stopped = self.stopped();
                    let next =
                        if stopped { Next::Wait } else { scheduler.next(study, optimizer)? };
                    match next {
                        Next::Ended(ending) => return Ok(ending),
                        Next::Evaluate(proposals) => {
                            running += proposals.len();
                            for proposal in proposals {
                                let sender = sender.clone();
                                scope.spawn(move |_| {
                                    // A panic is sent to the receiving thread, which resumes it.
                                    let evaluate = AssertUnwindSafe(|| self.evaluate(proposal));
                                    drop(sender.send(catch_unwind(evaluate)));
                                });
                            }
                        }
                        Next::CheckGain(told) => {
                            let stagnant = stagnates(study, told)?;
                            if !self.stopped() {
                                scheduler.record_stagnation(stagnant);
                            }
                        }
                        Next::Wait if running == 0 => return Ok(Ending::Interrupted),
                        Next::Wait => {
                            running -= 1;
                            // `sender` is alive, so there is always a message.
                            let Ok(result) = receiver.recv() else { continue };
                            let result = result.unwrap_or_else(|panic| {
                                self.stop.store(true, Ordering::SeqCst);
                                resume_unwind(panic)
                            })?;
                            if let Some(result) = result {
                                scheduler.accept(study, result, progress)?;
                            }
                        }
                    }
                }
            };
            run().inspect_err(|_| self.stop.store(true, Ordering::SeqCst))
        })
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    /// Evaluates a design; returns `None` if the run was cancelled before the evaluation was complete.
    fn evaluate(&self, proposal: Proposal) -> Result<Option<ProposalResult>, StudyError> {
        let result = (!self.stopped()).then(|| proposal.evaluate(self.evaluator));
        // A cancelled evaluation may lack trials.
        result.filter(|_| !self.stopped()).transpose()
    }
}

impl Proposal {
    /// Evaluates the design, against the best design if there is a race.
    ///
    /// # Errors
    /// If the design cannot be simulated.
    pub fn evaluate(&self, evaluator: &dyn Evaluate) -> Result<ProposalResult, StudyError> {
        let Proposal { number, design, race } = self;
        let (evaluations, timing) = Timing::of(|| evaluator.evaluate(design, race.as_ref()));
        let error = |source| StudyError::impossible(*number, design, source);
        Ok(ProposalResult { number: *number, evaluations: evaluations.map_err(error)?, timing })
    }
}
