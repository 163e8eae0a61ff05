//! Scheduler of a study: selects the designs to evaluate next and records their results. It does not
//! depend on how or where designs are evaluated.
//!
//! # Guarantee
//!
//! The journal is a function of the configuration; the budget only determines its length (or where
//! the polish begins; such a budget cannot be raised). Workers, threads and interruptions do not change
//! it: 20 evaluations followed by 20 more equal 40 at once, because
//!
//! - `ask` and `tell` of the optimizer are called with whole batches; where the budget ends within a
//!   batch, its first designs are evaluated and `tell` is not called;
//! - a resumed study replays all asks and tells with the values of the journal; a design that is
//!   proposed during the replay must equal the one in the journal;
//! - evaluations that finish out of order wait in memory until all earlier ones are written;
//! - if a result arrives twice, the first counts.
//!
//! An asynchronous study has no batches: `batch` designs are proposed at first, and one more after each
//! result. Its journal holds the results in order of arrival, each with the number of its proposal: it
//! depends on the speed of the workers, but can be replayed from that order.
//!
//! At most [`MAX_FAILED_STARTS`](super::record::MAX_FAILED_STARTS) designs are evaluated before one inserts
//! at its nominal start: if none does, the start or the strategy is wrong, and no other finger would
//! succeed. The rest of that batch is evaluated once a design has inserted.

use super::line;
use super::record::most_evaluations;
use super::{Recorded, Study, StudyError, Timing};
use ask_tell::GridPoint;
use ask_tell::{Observation, Optimizer, StopReason};
use insertion::{Design, Evaluations, Race, Score};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Reason for which a run of a study ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// The budget is spent.
    BudgetSpent,
    /// Every design of the space has been evaluated.
    SpaceExhausted,
    /// The polish has converged.
    Converged,
    /// No design is expected to improve on the best one by more than the indifference.
    Settled,
    /// None of the first designs inserts on any task.
    NothingInserts,
    /// The run was cancelled.
    Interrupted,
}

/// Largest absolute value of an objective; a larger one, or NaN, counts as failed.
const LARGEST_VALUE: f64 = 1e15;
/// Largest violation, which is relative to its limit and therefore huge if the limit is close to 0.
const LARGEST_VIOLATION: f64 = 1e30;

/// Design to be evaluated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Proposal {
    /// Number in the order of proposals, from 0.
    pub number: u64,
    /// The design.
    pub design: Design,
    /// Race for the success rate, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub race: Option<Race>,
}

/// Next step.
#[derive(Debug, Clone, PartialEq)]
pub enum Next {
    /// Evaluate these designs, in any order; each is returned once.
    Evaluate(Vec<Proposal>),
    /// Wait for a result.
    Wait,
    /// Check whether a gain is expected after this number of evaluations, and call
    /// [`record_stagnation`](Scheduler::record_stagnation).
    CheckGain(usize),
    /// The run has ended.
    Ended(Ending),
}

/// Result of a proposal.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposalResult {
    /// Number of the proposal.
    pub number: u64,
    /// Evaluations of the design.
    pub evaluations: Evaluations,
    /// Start, end and duration of the evaluation.
    pub timing: Timing,
}

/// Scheduler of a study: a state machine that is replayed from the journal.
#[derive(Default)]
pub struct Scheduler {
    batch: usize,
    /// Proposals whose results were not passed to `tell` yet, by number, each with the number of evaluations that were
    /// passed to `tell` before it.
    open: BTreeMap<u64, (GridPoint, usize)>,
    /// Number of proposals so far.
    proposed: u64,
    /// Number of evaluations passed to `tell`.
    told: usize,
    /// Designs being evaluated, by the number of the proposal.
    evaluating: BTreeMap<u64, Design>,
    /// Results that are written once all earlier ones have arrived, by index.
    waiting: BTreeMap<u64, Recorded>,
    /// Settings of early stopping (see [`StudyConfig::early_stopping`](super::StudyConfig::early_stopping)).
    early_stopping: Option<[usize; 2]>,
    /// Consecutive evaluations without an expected gain so far.
    stagnant: usize,
    /// Evaluations at the last check of a gain.
    checked: usize,
    /// Whether the search has stopped early.
    settled: bool,
    ended: Option<Ending>,
}

impl Scheduler {
    /// Returns the scheduler of a study, to be used with a new optimizer.
    pub fn new(study: &Study) -> Self {
        let (batch, early_stopping) = (study.config.batch as usize, study.config.early_stopping());
        let settled = study.config.settles && study.settled();
        Scheduler { batch, early_stopping, settled, ..Scheduler::default() }
    }

    /// Returns the next step.
    ///
    /// # Errors
    /// If the journal holds other designs than the optimizer proposes.
    pub fn next(
        &mut self,
        study: &Study,
        optimizer: &mut dyn Optimizer,
    ) -> Result<Next, StudyError> {
        while self.ended.is_none() {
            if !study.config.asynchronous && self.evaluating.is_empty() {
                self.tell_batch(study, optimizer);
            }
            if self.settled {
                // Running evaluations are written, too.
                let written = self.evaluating.is_empty();
                return Ok(if written { Next::Ended(Ending::Settled) } else { Next::Wait });
            }
            let least = self.early_stopping.map(|[least, _]| least.max(self.checked + 1));
            if least.is_some_and(|least| self.told >= least) {
                return Ok(Next::CheckGain(self.told));
            }
            let proposals = match study.config.asynchronous {
                true => self.next_arrivals(study, optimizer)?,
                false if self.evaluating.is_empty() => self.next_batch(study, optimizer)?,
                false => Vec::new(),
            };
            if !proposals.is_empty() {
                self.evaluating.extend(proposals.iter().map(|p| (p.number, p.design.clone())));
                return Ok(Next::Evaluate(proposals));
            }
            if !self.evaluating.is_empty() {
                return Ok(Next::Wait);
            }
        }
        Ok(Next::Ended(self.ended.unwrap_or(Ending::BudgetSpent)))
    }

    /// Records whether no gain was expected at the last [`CheckGain`](Next::CheckGain).
    pub fn record_stagnation(&mut self, stagnant: bool) {
        if let Some([_, patience]) = self.early_stopping {
            let more = (self.told - self.checked).min(self.batch);
            self.stagnant = if stagnant { self.stagnant + more } else { 0 };
            self.checked = self.told;
            self.settled = self.stagnant >= patience;
        }
    }

    /// Accepts the result of a proposal and writes all evaluations that are next in the journal.
    /// Returns false, without any effect, if the proposal is unknown or its result came before.
    ///
    /// # Errors
    /// If the journal cannot be written.
    pub fn accept(
        &mut self,
        study: &mut Study,
        result: ProposalResult,
        progress: &mut dyn FnMut(&Recorded),
    ) -> Result<bool, StudyError> {
        let ProposalResult { number, evaluations, timing } = result;
        let Evaluations { stiffness, tasks, cached } = evaluations;
        let Some(design) = self.evaluating.remove(&number) else { return Ok(false) };
        let (index, proposal) = match study.config.asynchronous {
            true => (study.evaluations.len() as u64, Some(number)),
            false => (number, None),
        };
        let goals = study.config.goals();
        let score = goals.score(&tasks.iter().collect::<Vec<_>>()).filter(is_bounded);
        let timing = Timing { cached, ..timing };
        let recorded = Recorded { index, proposal, design, score, stiffness, tasks, timing };
        self.waiting.insert(index, recorded);
        while let Some(recorded) = self.waiting.remove(&(study.evaluations.len() as u64)) {
            study.journal.write(line::encode(&recorded, &study.config.space))?;
            progress(&recorded);
            study.evaluations.push(recorded);
        }
        Ok(true)
    }

    /// Passes a batch to `tell` once all of it is evaluated.
    fn tell_batch(&mut self, study: &Study, optimizer: &mut dyn Optimizer) {
        let end = self.told + self.open.len();
        // If a limit ends within a batch, the rest has to be evaluated first.
        if end <= study.evaluations.len() && !self.open.is_empty() {
            let points = std::mem::take(&mut self.open).into_values();
            let found = study.evaluations.iter().skip(self.told);
            let told: Vec<Observation> = points
                .zip(found)
                .map(|((point, _), found)| study.observation(point, found))
                .collect();
            optimizer.tell(&told);
            self.told = end;
        }
    }

    /// Calls `ask` for the next batch; returns its designs that the journal does not contain.
    fn next_batch(
        &mut self,
        study: &Study,
        optimizer: &mut dyn Optimizer,
    ) -> Result<Vec<Proposal>, StudyError> {
        // After a limit was raised, the rest of its batch comes first.
        if self.open.is_empty() && self.told < Self::limit(study) {
            self.propose(optimizer, self.batch);
            if self.open.is_empty() {
                self.ended = Some(exhausted(optimizer));
                return Ok(Vec::new());
            }
        }
        let mut proposals = self.proposals(study);
        for Proposal { number, design, .. } in &proposals {
            if let Some(found) = study.evaluations.get(*number as usize)
                && found.design != *design
            {
                return Err(study.other_design(found, &design.to_string()));
            }
        }
        let known = study.evaluations.len();
        proposals.retain(|proposal| proposal.number >= known as u64);
        if proposals.is_empty() && (self.open.is_empty() || self.told + self.open.len() > known) {
            self.ended = Some(Self::spent(study));
        }
        Ok(proposals)
    }

    /// Calls `tell` for each new result and `ask` for one more design after it; returns the designs
    /// that are not being evaluated yet.
    fn next_arrivals(
        &mut self,
        study: &Study,
        optimizer: &mut dyn Optimizer,
    ) -> Result<Vec<Proposal>, StudyError> {
        // Independent of the budget, which may be raised later.
        if self.proposed == 0 {
            self.propose(optimizer, self.batch);
        }
        while let Some(found) = study.evaluations.get(self.told) {
            let number = found.proposal;
            let point = number.and_then(|number| self.open.remove(&number)).map(|(point, _)| point);
            let Some(point) = point.filter(|p| study.config.space.design(p) == found.design) else {
                return Err(study.other_design(found, "another in its place"));
            };
            optimizer.tell(&[study.observation(point, found)]);
            self.told += 1;
            self.propose(optimizer, 1);
        }
        let mut proposals = self.proposals(study);
        proposals.retain(|proposal| !self.evaluating.contains_key(&proposal.number));
        if proposals.is_empty() && self.evaluating.is_empty() {
            let spent = self.told >= Self::limit(study);
            self.ended = Some(if spent { Self::spent(study) } else { exhausted(optimizer) });
        }
        Ok(proposals)
    }

    fn propose(&mut self, optimizer: &mut dyn Optimizer, count: usize) {
        for point in optimizer.ask(count) {
            self.open.insert(self.proposed, (point, self.told));
            self.proposed += 1;
        }
    }

    /// Returns the largest number of evaluations of a study.
    fn limit(study: &Study) -> usize {
        most_evaluations(&study.config, &study.segments, &study.evaluations) as usize
    }

    /// Returns the ending of a study at its limit.
    fn spent(study: &Study) -> Ending {
        match (Self::limit(study) as u64) < study.config.evaluations() {
            true => Ending::NothingInserts,
            false => Ending::BudgetSpent,
        }
    }

    /// Returns the proposals within the limit whose results were not passed to `tell` yet.
    fn proposals(&self, study: &Study) -> Vec<Proposal> {
        let limit = Self::limit(study) as u64;
        let within = self.open.iter().filter(|(number, _)| **number < limit);
        let proposal = |(&number, (point, told)): (&u64, &(GridPoint, usize))| Proposal {
            number,
            design: study.config.space.design(point),
            race: study.race(*told),
        };
        within.map(proposal).collect()
    }
}

/// Returns whether all values are numbers small enough for sums and plots.
fn is_bounded(score: &Score) -> bool {
    score.values.iter().all(|value| value.abs() <= LARGEST_VALUE)
        && score.violations.iter().all(|share| share.abs() <= LARGEST_VIOLATION)
}

fn exhausted(optimizer: &dyn Optimizer) -> Ending {
    match optimizer.stop() {
        Some(StopReason::Converged) => Ending::Converged,
        Some(StopReason::GridExhausted) | None => Ending::SpaceExhausted,
    }
}

impl Study {
    /// Returns the result of a point for the optimizer.
    fn observation(&self, point: GridPoint, recorded: &Recorded) -> Observation {
        let values = || {
            let score = recorded.score.as_ref()?;
            Some((self.config.goals().interpolated(&recorded.tasks())?, score.violations.clone()))
        };
        let (values, violations) = values().unwrap_or_default();
        Observation { point, values, violations }
    }

    /// Returns the error for an evaluation of the journal whose design differs from the proposed one.
    fn other_design(&self, found: &Recorded, proposed: &str) -> StudyError {
        let problem = format!(
            "evaluation {} is of {}, but this version of the program proposes {proposed}: the journal \
             was written by another version; resume it with that version, or start a new study",
            found.index, found.design
        );
        StudyError::file(&self.journal.path, problem)
    }
}
