//! The course of a study: what is to be measured next, and what was. Who measures, and where,
//! is not known here.
//!
//! # Guarantee
//!
//! The journal is a function of the configuration; the budget only says where it ends (or where a
//! polish begins, and then it cannot be raised). Neither workers and threads nor interruptions change
//! it: 20 evaluations and then 20 more are the same as 40 at once. This holds because
//!
//! - the optimizer is asked for whole batches and told whole batches; a budget that ends within a
//!   batch evaluates its first designs and tells nothing;
//! - a study that goes on starts its optimizer anew and repeats asks and tells with the values of the
//!   journal; what it proposes on the way must be what the journal holds;
//! - evaluations that end out of order wait in memory until all earlier ones are written;
//! - of results that come twice the first counts.
//!
//! An asynchronous study has no batches: `batch` designs are proposed at first, and one more for each
//! result, which is told at once. Its journal has the results in the order in which they arrived, each
//! with the number of its proposal: it depends on who was fast, but repeats from that order alone.
//!
//! Until a design has inserted at its nominal start no more than [`FUTILE`] are measured, whatever the
//! batch: where none of so many does, start or strategy are wrong, and no finger mends them. What is
//! left of a batch then is measured once one has inserted.

use super::error::StudyError;
use super::fits;
use super::folder::Study;
use super::record::{Recorded, Timing, first_current};
use ask_tell::GridPoint;
use ask_tell::{Observation, Optimizer, StopReason};
use insertion::evaluation::evaluator::Measured;
use insertion::evaluation::objective::Goals;
use insertion::evaluation::robustness::race::Race;
use insertion::space::Design;
use std::collections::BTreeMap;

/// Why a run of a study ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// As many designs were evaluated as the budget allows.
    BudgetSpent,
    /// Every design of the space has been evaluated.
    SpaceExhausted,
    /// The polish has found what it can find.
    Converged,
    /// No design is expected to gain what matters.
    Settled,
    /// None of the first designs inserts on any task.
    NothingInserts,
    /// It was told to stop.
    Interrupted,
}

/// Evaluations of the present model, none of which inserts, after which a study ends.
const FUTILE: usize = 12;

/// A design that is to be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Wanted {
    /// Its number in the order in which designs were proposed, from 0.
    pub proposal: u64,
    pub design: Design,
    /// Race that it is measured in, if it is.
    pub race: Option<Race>,
}

/// Next step.
#[derive(Debug, Clone, PartialEq)]
pub enum Next {
    /// Measure these, in any order; they are not given again.
    Measure(Vec<Wanted>),
    /// Wait for a result of what is being measured.
    Wait,
    /// Say, by [`judged`](Course::judged), whether a gain is expected after so many evaluations.
    Judge(usize),
    Ended(Ending),
}

/// Result of measuring a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Arrived {
    /// The number of its proposal.
    pub proposal: u64,
    pub measured: Measured,
    /// When, and how long it took.
    pub timing: Timing,
}

/// How a study goes on, from its beginning or from what its journal holds.
pub struct Course {
    goals: Goals,
    batch: usize,
    budget: usize,
    asynchronous: bool,
    /// Proposed and not told yet, by the number of the proposal; with how many were told before it.
    open: BTreeMap<u64, (GridPoint, usize)>,
    /// How many were proposed.
    proposed: u64,
    /// How many evaluations the optimizer was told.
    told: usize,
    /// Given out and not written, by the number of the proposal.
    measuring: BTreeMap<u64, Design>,
    /// Measured, and to be written after earlier ones, by the same number.
    waiting: BTreeMap<u64, Recorded>,
    settling: Option<Settling>,
    ended: Option<Ending>,
}

/// When a search ends that has no budget but a limit.
#[derive(Debug, Clone, Copy)]
struct Settling {
    /// Evaluations before which nothing is judged.
    least: usize,
    /// Evaluations in a row after which no gain has to be expected.
    quiet: usize,
    /// Those so far.
    calm: usize,
    /// Evaluations at the last judgement.
    judged: usize,
    settled: bool,
}

impl Settling {
    fn of(study: &Study) -> Option<Self> {
        let [least, quiet] = study.config.settling()?;
        Some(Settling { least, quiet, calm: 0, judged: 0, settled: study.settled() })
    }
}

impl Course {
    /// The course of this study, whose optimizer is new.
    pub fn new(study: &Study) -> Self {
        let number = |n: u64| usize::try_from(n).unwrap_or(usize::MAX);
        Course {
            goals: study.config.goals(),
            batch: number(study.config.batch),
            budget: number(study.config.evaluations()),
            asynchronous: study.config.asynchronous,
            open: BTreeMap::new(),
            proposed: 0,
            told: 0,
            measuring: BTreeMap::new(),
            waiting: BTreeMap::new(),
            settling: Settling::of(study),
            ended: None,
        }
    }

    /// Next step.
    ///
    /// # Errors
    /// If the journal holds other designs than the optimizer proposes.
    pub fn next(
        &mut self,
        study: &Study,
        optimizer: &mut dyn Optimizer,
    ) -> Result<Next, StudyError> {
        while self.ended.is_none() {
            if !self.asynchronous && self.measuring.is_empty() {
                self.tell_batch(study, optimizer);
            }
            match self.settling {
                // What is being measured is waited for: it is written, too.
                Some(Settling { settled: true, .. }) if self.measuring.is_empty() => {
                    self.ended = Some(Ending::Settled);
                    continue;
                }
                Some(Settling { settled: true, .. }) => return Ok(Next::Wait),
                Some(Settling { least, judged, .. }) if self.told >= least.max(judged + 1) => {
                    return Ok(Next::Judge(self.told));
                }
                _ => {}
            }
            let wanted = match self.asynchronous {
                true => self.next_arrivals(study, optimizer)?,
                false if self.measuring.is_empty() => self.next_batch(study, optimizer)?,
                false => Vec::new(),
            };
            if !wanted.is_empty() {
                let given = wanted.iter().map(|w| (w.proposal, w.design.clone()));
                self.measuring.extend(given);
                return Ok(Next::Measure(wanted));
            }
            if !self.measuring.is_empty() {
                return Ok(Next::Wait);
            }
        }
        Ok(Next::Ended(self.ended.unwrap_or(Ending::BudgetSpent)))
    }

    /// Whether no gain was expected at the last [`Judge`](Next::Judge).
    pub fn judged(&mut self, calm: bool) {
        let (told, batch) = (self.told, self.batch);
        if let Some(settling) = &mut self.settling {
            let more = (told - settling.judged).min(batch);
            settling.calm = if calm { settling.calm + more } else { 0 };
            settling.judged = told;
            settling.settled = settling.calm >= settling.quiet;
        }
    }

    /// Takes in what was measured of a design that was given out, and writes down what is in
    /// turn. False, and nothing is changed, if its result is not awaited: it came before.
    pub fn take(
        &mut self,
        study: &mut Study,
        result: Arrived,
        progress: &mut dyn FnMut(&Recorded),
    ) -> Result<bool, StudyError> {
        let Arrived { proposal, measured: Measured { stiffness, tasks, .. }, timing } = result;
        let Some(design) = self.measuring.get(&proposal).cloned() else { return Ok(false) };
        if self.waiting.contains_key(&proposal) {
            return Ok(false);
        }
        let (index, proposal_written) = match self.asynchronous {
            true => (study.evaluations.len() as u64, Some(proposal)),
            false => (proposal, None),
        };
        let mut recorded = Recorded {
            index,
            proposal: proposal_written,
            design,
            score: None,
            stiffness,
            tasks,
            timing,
            refused: None,
        };
        // What is no number has failed.
        recorded.score = self.goals.score(&recorded.tasks()).filter(fits::sound);
        self.waiting.insert(proposal, recorded);
        while let Some((proposal, recorded)) = self.next_written(study) {
            let written = study.journal.append(&recorded);
            if let Err(StudyError::Interfered { .. }) | Ok(()) = written {
                progress(&recorded);
                // What is not in the journal is saved with the rest.
                study.evaluations.push(recorded);
                self.measuring.remove(&proposal);
            }
            written?;
        }
        Ok(true)
    }

    /// The result whose turn it is, if it is here.
    fn next_written(&mut self, study: &Study) -> Option<(u64, Recorded)> {
        let next = study.evaluations.len() as u64;
        let proposal =
            self.waiting.iter().find(|(_, found)| found.index == next).map(|(n, _)| *n)?;
        self.waiting.remove_entry(&proposal)
    }

    /// Tells the batch that was measured.
    fn tell_batch(&mut self, study: &Study, optimizer: &mut dyn Optimizer) {
        let end = self.told + self.open.len();
        // A limit within a batch tells nothing of it before the rest was measured, too.
        if end <= study.evaluations.len() && !self.open.is_empty() {
            let points = std::mem::take(&mut self.open).into_values();
            let found = study.evaluations.iter().skip(self.told);
            let told: Vec<Observation> = points
                .zip(found)
                .map(|((point, _), found)| self.observation(point, found))
                .collect();
            optimizer.tell(&told);
            self.told = end;
        }
    }

    /// Asks for the next batch; gives what the journal does not hold of it.
    fn next_batch(
        &mut self,
        study: &Study,
        optimizer: &mut dyn Optimizer,
    ) -> Result<Vec<Wanted>, StudyError> {
        // What is left of a batch at a limit that has risen comes first.
        if self.open.is_empty() && self.told < self.limit(study) {
            self.propose(optimizer, self.batch);
            if self.open.is_empty() {
                self.ended = Some(exhausted(optimizer));
                return Ok(Vec::new());
            }
        }
        let mut wanted = self.wanted(study);
        for wanted in &wanted {
            match study.evaluations.get(wanted.proposal as usize) {
                Some(found) if found.design != wanted.design => {
                    return Err(study.other_design(found, &wanted.design.to_string()));
                }
                _ => {}
            }
        }
        let known = study.evaluations.len();
        wanted.retain(|wanted| wanted.proposal >= known as u64);
        if wanted.is_empty() && (self.open.is_empty() || self.told + self.open.len() > known) {
            self.ended = Some(self.spent(study));
        }
        Ok(wanted)
    }

    /// Tells what has arrived, one by one, asks for one more after each, and gives what is not
    /// being measured yet.
    fn next_arrivals(
        &mut self,
        study: &Study,
        optimizer: &mut dyn Optimizer,
    ) -> Result<Vec<Wanted>, StudyError> {
        // Whatever the budget is: it may be raised later.
        if self.proposed == 0 {
            self.propose(optimizer, self.batch);
        }
        while let Some(found) = study.evaluations.get(self.told) {
            let number = found.proposal;
            let point = number.and_then(|number| self.open.remove(&number)).map(|(point, _)| point);
            let Some(point) = point.filter(|p| study.config.space.design(p) == found.design) else {
                return Err(study.other_design(found, "another in its place"));
            };
            optimizer.tell(&[self.observation(point, found)]);
            self.told += 1;
            self.propose(optimizer, 1);
        }
        let mut wanted = self.wanted(study);
        wanted.retain(|wanted| !self.measuring.contains_key(&wanted.proposal));
        if wanted.is_empty() && self.measuring.is_empty() {
            let spent = self.told >= self.limit(study);
            self.ended = Some(if spent { self.spent(study) } else { exhausted(optimizer) });
        }
        Ok(wanted)
    }

    fn propose(&mut self, optimizer: &mut dyn Optimizer, count: usize) {
        for point in optimizer.ask(count) {
            self.open.insert(self.proposed, (point, self.told));
            self.proposed += 1;
        }
    }

    /// Evaluations after which nothing more is measured: the budget, or fewer as long as nothing
    /// inserts.
    fn limit(&self, study: &Study) -> usize {
        let first = first_current(study.segments()) as usize;
        match study.evaluations.iter().skip(first).any(Recorded::inserts) {
            true => self.budget,
            false => self.budget.min(first + FUTILE),
        }
    }

    /// Why it ends at its limit.
    fn spent(&self, study: &Study) -> Ending {
        if self.limit(study) < self.budget { Ending::NothingInserts } else { Ending::BudgetSpent }
    }

    /// The designs that were proposed within the limit and are not told yet.
    fn wanted(&self, study: &Study) -> Vec<Wanted> {
        let limit = self.limit(study) as u64;
        let within = self.open.iter().filter(|(number, _)| **number < limit);
        let wanted = |(&proposal, (point, told)): (&u64, &(GridPoint, usize))| {
            let design = study.config.space.design(point);
            Wanted { proposal, design, race: study.race(*told) }
        };
        within.map(wanted).collect()
    }

    fn observation(&self, point: GridPoint, recorded: &Recorded) -> Observation {
        let told = match &recorded.refused {
            // Told as it was then, so that the designs that follow repeat.
            Some(refused) => refused.told.clone(),
            None => fits::told(recorded, &self.goals),
        };
        match told {
            None => Observation::new(point, None),
            Some([values, violations]) => Observation { point, values, violations },
        }
    }
}

fn exhausted(optimizer: &dyn Optimizer) -> Ending {
    match optimizer.stop() {
        Some(StopReason::Converged) => Ending::Converged,
        Some(StopReason::GridExhausted) | None => Ending::SpaceExhausted,
    }
}

impl Study {
    /// The journal holds this evaluation where another design is proposed now.
    fn other_design(&self, found: &Recorded, proposed: &str) -> StudyError {
        let problem = format!(
            "evaluation {} is of {}, but this version of the program proposes {proposed}: the journal \
             was written by another version; continue it with that one, or start a new study",
            found.index, found.design
        );
        StudyError::file(&self.journal.path, problem)
    }
}
