//! Study whose designs are evaluated by the caller, for example in a process pool or on a cluster.

use super::best_so_far::BestSoFar;
use super::open::{Ended, OpenStudy, cached_evaluator, confirmer, hint, resume_hint};
use super::optimizer::optimizer;
use crate::{Context, Failure, RunRequest, Setup, not_stopped};
use ask_tell::Optimizer;
use insertion::trial::NEVER;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};
use study::{
    CachedEvaluator, ConfirmationLog, Ending, Next, Proposal, ProposalResult, Scheduler, Timing,
    Work, WorkError,
};

/// Open study with its scheduler and the evaluations in progress.
pub struct AskTellStudy {
    open: OpenStudy,
    optimizer: Box<dyn Optimizer + Send>,
    scheduler: Scheduler,
    /// Evaluations in progress, by the number of the proposal.
    evaluating: BTreeMap<u64, Work>,
    best_so_far: BestSoFar,
    log: ConfirmationLog,
}

/// Next step of the caller.
pub enum NextStep {
    /// Evaluate these proposals: number of each, and the encoded work, the argument of [`perform`].
    Evaluate(Vec<(u64, Vec<u8>)>),
    /// Wait for a result.
    Wait,
    /// Call [`finish`](AskTellStudy::finish).
    Finish(Ending),
}

/// Reason for which a result was rejected.
pub enum RejectedResult {
    /// The result is invalid; the evaluation may be repeated.
    Refused(WorkError),
    /// The study cannot continue.
    Failed(Failure),
}

impl AskTellStudy {
    /// Returns a study whose designs the caller evaluates.
    ///
    /// # Errors
    /// If the optimizer cannot be created.
    pub fn new(open: OpenStudy) -> Result<Self, Failure> {
        let optimizer = optimizer(&open.setup, &open.study.config)?;
        let (scheduler, best_so_far) = (Scheduler::new(&open.study), BestSoFar::new(&open.study));
        let log = ConfirmationLog::open(&open.study);
        let evaluating = BTreeMap::new();
        Ok(AskTellStudy { open, optimizer, scheduler, evaluating, best_so_far, log })
    }

    /// Returns the next step. Designs in the cache are not evaluated again.
    ///
    /// # Errors
    /// If the journal contains other designs than the optimizer proposes, or cannot be written.
    pub fn next_step(&mut self, stop: &AtomicBool) -> Result<NextStep, Failure> {
        loop {
            match self.scheduler.next(&self.open.study, &mut *self.optimizer)? {
                Next::Wait => return Ok(NextStep::Wait),
                Next::Ended(ending) => return Ok(NextStep::Finish(ending)),
                Next::CheckGain(told) => {
                    let (pool, context) = (self.open.run.pool()?, Context::silent(stop));
                    let OpenStudy { study, setup, cache, .. } = &self.open;
                    let confirmer = confirmer(setup, cache.as_ref(), &pool, &context);
                    let stagnant = confirmer.stagnates(study, &mut self.log, told)?;
                    not_stopped(stop)?;
                    self.scheduler.record_stagnation(stagnant);
                }
                Next::Evaluate(proposals) => {
                    let mut unknown = Vec::new();
                    for proposal in proposals {
                        if !self.accept_cached(&proposal)? {
                            unknown.push(self.assign(proposal)?);
                        }
                    }
                    if !unknown.is_empty() {
                        return Ok(NextStep::Evaluate(unknown));
                    }
                }
            }
        }
    }

    /// Returns the evaluator of designs with its cache.
    fn evaluator(&self) -> CachedEvaluator<'_> {
        let OpenStudy { setup, cache, plan, .. } = &self.open;
        cached_evaluator(setup, cache.as_ref(), plan, &NEVER)
    }

    /// Accepts the evaluation of a design from the cache; returns false if the cache does not contain it.
    fn accept_cached(
        &mut self,
        Proposal { number, design, race }: &Proposal,
    ) -> Result<bool, Failure> {
        let (known, timing) = Timing::of(|| self.evaluator().cached(design, race.as_ref()));
        let Some(evaluations) = known else { return Ok(false) };
        self.accept(ProposalResult { number: *number, evaluations, timing })
    }

    /// Records that a proposal is being evaluated; returns its number and its encoded work.
    fn assign(&mut self, proposal: Proposal) -> Result<(u64, Vec<u8>), Failure> {
        let OpenStudy { study, setup, .. } = &self.open;
        let (number, seed) = (proposal.number, study.config.seed);
        let [success_rate, robust_range] = study.config.goals().needs_draws();
        let (provenance, inputs) = (study.provenance().clone(), setup.inputs.clone());
        let work = Work { proposal, seed, success_rate, robust_range, provenance, inputs };
        let bytes = work.encode().map_err(|error| Failure::running(error.to_string()))?;
        self.evaluating.insert(number, work);
        Ok((number, bytes))
    }

    /// Accepts the result of a proposal; returns false if the proposal already has one.
    ///
    /// # Errors
    /// If the result does not belong to the proposal, or the journal cannot be written.
    pub fn take(&mut self, number: u64, result: &[u8]) -> Result<bool, RejectedResult> {
        let Some(work) = self.evaluating.get(&number) else { return Ok(false) };
        let Proposal { design, race, .. } = &work.proposal;
        let impossible = |error| RejectedResult::Failed(Failure::input(error));
        let stiffness = self.open.setup.evaluator.predict(design).map_err(impossible)?;
        let result = work.check(result, stiffness).map_err(RejectedResult::Refused)?;
        self.evaluator().store(design, race.as_ref(), &result.evaluations);
        let taken = self.accept(result).map_err(RejectedResult::Failed)?;
        self.evaluating.remove(&number);
        Ok(taken)
    }

    fn accept(&mut self, result: ProposalResult) -> Result<bool, Failure> {
        let (best_so_far, study) = (&mut self.best_so_far, &mut self.open.study);
        let taken = self.scheduler.accept(study, result, &mut |recorded| best_so_far.add(recorded));
        taken.map_err(|error| hint(error, study))
    }

    /// Returns the number of evaluations done, the expected total, and the best value so far as text.
    pub fn progress(&self) -> (usize, u64, String) {
        let study = &self.open.study;
        let done = study.evaluations.len();
        (done, study.config.expected_evaluations().max(done as u64), self.best_so_far.best())
    }

    /// Returns the command that resumes the study, with its progress.
    pub fn hint(&self) -> String {
        resume_hint(&self.open.study)
    }

    /// Confirms the recommended design on the threads of this process, and writes tables and report.
    ///
    /// # Errors
    /// If a design cannot be simulated or a file cannot be written; if `stop` is set meanwhile.
    pub fn finish(&mut self, ending: Ending, stop: &AtomicBool) -> Result<Ended, Failure> {
        let pool = self.open.run.pool()?;
        self.open.conclude(ending, &mut self.log, &pool, &Context::silent(stop))
    }

    /// Returns the number of threads of this process; 0 for one per processor.
    pub fn threads(&self) -> usize {
        self.open.run.threads()
    }
}

/// Last setup with the inputs that determine it, since a worker evaluates many designs of one study.
static LAST: Mutex<Option<(Value, Arc<Setup>)>> = Mutex::new(None);

fn set_up(work: &Work) -> Result<Arc<Setup>, Failure> {
    let key = json!([work.inputs, work.provenance.engine.name]);
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((known, setup)) = &*last
        && *known == key
    {
        return Ok(Arc::clone(setup));
    }
    let setup = Arc::new(Setup::from_inputs(&work.inputs, &work.provenance.engine.name)?);
    *last = Some((key, Arc::clone(&setup)));
    Ok(setup)
}

/// Evaluates the encoded work of an [`AskTellStudy`] and returns the encoded result, which depends only on the work;
/// `worker` names the host and process that run it.
///
/// # Errors
/// If the bytes are invalid, this program has another provenance than the study, or the design cannot be
/// simulated; if `stop` is set meanwhile.
pub fn perform(bytes: &[u8], worker: &str, stop: &AtomicBool) -> Result<Vec<u8>, Failure> {
    // One thread, since the caller has a worker for each processor; and a new one, since a forked process
    // lacks the threads of the shared pool.
    RunRequest { threads: Some(1), ..RunRequest::default() }.pool()?.install(|| {
        let work = Work::decode(bytes).map_err(Failure::input)?;
        let setup = set_up(&work)?;
        work.check_worker(&setup.provenance(), worker).map_err(Failure::input)?;
        let plan = setup.plan(work.seed, [work.success_rate, work.robust_range])?;
        let result = work.proposal.evaluate(&cached_evaluator(&setup, None, &plan, stop))?;
        not_stopped(stop)?;
        work.encode_result(result).map_err(|error| Failure::running(error.to_string()))
    })
}
