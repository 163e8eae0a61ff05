//! Measurements that confirm the best designs of a study; see `confirmed.rs`.

use super::config::StudyConfig;
use super::confirmed::{ConfirmationFile, ConfirmedDesign, Walk, with_windows};
use super::error::StudyError;
use super::folder::Study;
use super::provenance::Provenance;
use super::record::{ByRibs, Recorded};
use super::rule::{Rank, Rule};
use ask_tell::Grid;
use ask_tell::gp::{Advice, DEFAULT_NOISE_FLOOR, Gain, Outlook};
use insertion::evaluation::Evaluation;
use insertion::evaluation::evaluator::{Evaluate, Evaluator};
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::robustness::firm::Firm;
use insertion::evaluation::template::{Impossible, Template};
use insertion::evaluation::tolerance::Search;
use insertion::space::Design;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Evaluators and settings of the confirmation.
pub struct Confirmer<'a> {
    /// Walks a design.
    pub walker: &'a dyn Evaluate,
    /// Evaluator of computed fingers, if the study's fingers are those of the paper.
    pub by_ribs: Option<&'a Evaluator>,
    /// Evaluator of the study.
    pub evaluator: &'a Evaluator,
    /// Threads that simulate.
    pub pool: &'a ThreadPool,
    /// Cancels the confirmation once it is set: trials then end at once.
    pub stop: &'a AtomicBool,
    /// Skips the confirmation.
    pub no_confirm: bool,
    /// Progress callback: design, number of designs done, and of all.
    pub done: &'a (dyn Fn(Confirmed, &Recorded, [usize; 2]) + Sync),
}

/// Kind of confirmation of a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Confirmed {
    /// Its ends were repeated.
    Repeated,
    /// It was walked step by step.
    Walked,
}

/// Returns the gain over the best confirmed design that counts.
pub(super) fn gain(config: &StudyConfig) -> Gain {
    let (least, noise_floor) = (config.indifference_mm, DEFAULT_NOISE_FLOOR);
    Gain { least, probability: 0.02, noise_floor, floor: 0.0 }
}

/// Designs confirmed at a time, independent of the number of threads.
const AT_ONCE: usize = 2;

impl Confirmer<'_> {
    /// Confirms the best designs of a study that has ended, and writes each to the log; `settled` is whether
    /// the search stopped early.
    ///
    /// # Errors
    /// If a design cannot be simulated, or the log cannot be written.
    pub fn confirm(
        &self,
        study: &Study,
        log: &ConfirmationLog,
        settled: bool,
    ) -> Result<(), StudyError> {
        let goals = study.config.goals();
        let rule = Rule { goals: &goals, space: &study.config.space };
        // The confirmation of a settled study is part of its search and is not repeated.
        if !rule.by_windows() || (settled && study.settled()) {
            return Ok(());
        }
        self.by_expectation(study, log, study.evaluations.len(), false)?;
        if self.stop.load(Ordering::SeqCst) {
            return Ok(());
        }
        log.finish(settled.then_some(study.evaluations.len() as u64))
    }

    /// Returns whether no gain is expected after the first `told` evaluations; confirms the designs on which
    /// that depends.
    ///
    /// # Errors
    /// If a design cannot be simulated, or the log cannot be written.
    pub fn stagnates(
        &self,
        study: &Study,
        log: &ConfirmationLog,
        told: usize,
    ) -> Result<bool, StudyError> {
        Ok(self.by_expectation(study, log, told, true)? == Advice::Settled)
    }

    fn by_expectation(
        &self,
        study: &Study,
        log: &ConfirmationLog,
        told: usize,
        searching: bool,
    ) -> Result<Advice, StudyError> {
        let (record, goals, seed) = (study.record(), study.config.goals(), study.config.seed);
        let rule = Rule { goals: &goals, space: &study.config.space };
        let current = record.current();
        let current =
            &current[..told.saturating_sub(record.first_current() as usize).min(current.len())];
        let ranks: Vec<Rank> = current.iter().map(|found| rule.as_recorded(found)).collect();
        let space = &study.config.space;
        let grid = Grid::new(space.levels());
        let observed = rule.observed(current);
        let mut order: Vec<usize> = (0..current.len()).collect();
        order.sort_by(|&a, &b| rule.order(&ranks[a], &ranks[b]));
        let mut places = vec![0; order.len()];
        order.iter().enumerate().for_each(|(place, &at)| places[at] = place);
        loop {
            let known = |(at, found): (usize, &Recorded)| {
                let row = log.get(found)?;
                let rank = match &row.walked {
                    None => rule.firmly(found, &row.firm),
                    Some(walk) => rule.firmly(&with_windows(&rule, found, &walk.tasks), &walk.firm),
                };
                let (value, last) = (rank.value().unwrap_or(0.0), row.walked.is_some());
                Some(ask_tell::gp::Confirmed { at, value, last })
            };
            let confirmed: Vec<_> = current.iter().enumerate().filter_map(known).collect();
            let outlook = Outlook::new(&grid, &observed, &confirmed, gain(&study.config));
            let advice = match searching {
                true => outlook.advise(&places, AT_ONCE),
                false => outlook.confirm_only(&places, AT_ONCE),
            };
            let Advice::Confirm(chosen) = &advice else { return Ok(advice) };
            // Without confirmation the results of the search are taken as they are.
            if self.no_confirm {
                return Ok(Advice::Settled);
            }
            let chosen: Vec<&Recorded> = chosen.iter().map(|&at| &current[at]).collect();
            let walking = chosen.iter().any(|found| log.get(found).is_some());
            let phase = if walking { Confirmed::Walked } else { Confirmed::Repeated };
            log.select(&chosen);
            self.each(phase, &chosen, |found| self.further(found, log, seed))?;
            if self.stop.load(Ordering::SeqCst) {
                return Ok(Advice::Search);
            }
        }
    }

    /// Repeats a design or, if it was repeated, walks it; a result of an earlier run is used again.
    fn further(
        &self,
        found: &Recorded,
        log: &ConfirmationLog,
        seed: u64,
    ) -> Result<(), StudyError> {
        let earlier = log.earlier.iter().find(|row| row.evaluation == found.index).cloned();
        let row = match (log.get(found), earlier) {
            (None, Some(earlier)) => {
                return log.set(ConfirmedDesign { walked: None, ..earlier }, false);
            }
            (Some(_), Some(earlier)) if earlier.walked.is_some() => return log.set(earlier, false),
            (None, None) => {
                let firm = self.firm(found, &[], seed)?;
                ConfirmedDesign { evaluation: found.index, firm, walked: None }
            }
            (Some(row), _) => self.walk(found, row, seed)?,
        };
        // After cancellation trials may have been skipped.
        if self.stop.load(Ordering::SeqCst) { Ok(()) } else { log.set(row, true) }
    }

    /// Calls `what` with each design in parallel.
    fn each(
        &self,
        phase: Confirmed,
        designs: &[&Recorded],
        what: impl Fn(&Recorded) -> Result<(), StudyError> + Sync,
    ) -> Result<(), StudyError> {
        let count = AtomicUsize::new(0);
        let one = |recorded: &&Recorded| {
            what(recorded)?;
            let done = count.fetch_add(1, Ordering::Relaxed) + 1;
            (self.done)(phase, recorded, [done, designs.len()]);
            Ok(())
        };
        self.pool.install(|| designs.par_iter().try_for_each(one))
    }

    /// Walks a design and repeats the ends that changed.
    fn walk(
        &self,
        searched: &Recorded,
        row: ConfirmedDesign,
        seed: u64,
    ) -> Result<ConfirmedDesign, StudyError> {
        let found = self.walker.evaluate(&searched.design);
        let tasks = found
            .map_err(|source| StudyError::impossible(searched.index, &searched.design, source))?
            .tasks;
        let mut walked = searched.clone();
        let same = |(before, now): (&Evaluation, &Evaluation)| before.window == now.window;
        let windows = searched.tasks.iter().zip(&tasks).zip(&row.firm);
        let as_before: Vec<Option<Firm>> =
            windows.map(|(windows, firm)| same(windows).then_some(*firm)).collect();
        walked.tasks.clone_from(&tasks);
        let firm = self.firm(&walked, &as_before, seed)?;
        let computed = self.by_ribs.map(|evaluator| self.computed(evaluator, &searched.design));
        Ok(ConfirmedDesign { walked: Some(Walk { tasks, firm, computed }), ..row })
    }

    /// Evaluates a design with the stiffnesses computed from its ribs.
    fn computed(&self, evaluator: &Evaluator, design: &Design) -> ByRibs {
        let measured = evaluator.evaluate_by(design, |specimen| {
            evaluator.measure_or_teach(specimen, Search::default(), &Plan::WINDOW, self.stop)
        });
        match measured {
            Ok(found) => ByRibs::Measured(found.tasks),
            Err(why) => ByRibs::Refused(why.to_string()),
        }
    }

    /// Returns the firm windows of a design on all tasks; `known` ones are not measured again.
    fn firm(
        &self,
        recorded: &Recorded,
        known: &[Option<Firm>],
        seed: u64,
    ) -> Result<Vec<Firm>, StudyError> {
        let measure = |(at, (template, task)): (usize, (&Template, &Evaluation))| {
            if let Some(Some(firm)) = known.get(at) {
                return Ok(*firm);
            }
            let specimen =
                self.evaluator.specimen(template, &recorded.design, recorded.stiffness)?;
            Ok(self.evaluator.firm(&specimen, task, seed, self.stop)?)
        };
        let tasks = self.evaluator.templates.iter().zip(&recorded.tasks).enumerate();
        let firm: Result<Vec<Firm>, Impossible> = tasks.map(measure).collect();
        firm.map_err(|source| StudyError::impossible(recorded.index, &recorded.design, source))
    }
}

/// Log of the confirmed designs: `walk.json` while it is written.
pub struct ConfirmationLog {
    dir: PathBuf,
    provenance: Provenance,
    /// Results of an earlier run.
    earlier: Vec<ConfirmedDesign>,
    /// Selected designs, in that order, with their results.
    rows: Mutex<Vec<(u64, Option<ConfirmedDesign>)>>,
}

impl ConfirmationLog {
    /// Reads the results of an earlier run.
    pub fn open(study: &Study) -> Self {
        let (dir, provenance) = (study.dir().to_owned(), study.provenance().clone());
        let file = ConfirmationFile::read(&dir, Some(&provenance));
        let earlier = file.map_or(Vec::new(), |file| file.designs);
        ConfirmationLog { dir, provenance, earlier, rows: Mutex::default() }
    }

    fn rows(&self) -> MutexGuard<'_, Vec<(u64, Option<ConfirmedDesign>)>> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds designs that were selected for the first time.
    fn select(&self, chosen: &[&Recorded]) {
        let mut rows = self.rows();
        for found in chosen {
            if !rows.iter().any(|(index, _)| *index == found.index) {
                rows.push((found.index, None));
            }
        }
    }

    fn get(&self, recorded: &Recorded) -> Option<ConfirmedDesign> {
        self.rows().iter().find(|(index, _)| *index == recorded.index)?.1.clone()
    }

    /// Sets the result of a selected design; `write` is whether it is new.
    fn set(&self, result: ConfirmedDesign, write: bool) -> Result<(), StudyError> {
        let mut rows = self.rows();
        if let Some((_, row)) = rows.iter_mut().find(|(index, _)| *index == result.evaluation) {
            *row = Some(result);
        }
        if write { self.write(&rows, None) } else { Ok(()) }
    }

    fn finish(&self, settled_after: Option<u64>) -> Result<(), StudyError> {
        self.write(&self.rows(), Some(settled_after))
    }

    /// Writes the file; `finished` holds the evaluations after which a complete study settled.
    fn write(
        &self,
        rows: &[(u64, Option<ConfirmedDesign>)],
        finished: Option<Option<u64>>,
    ) -> Result<(), StudyError> {
        let designs = rows.iter().filter_map(|(_, row)| row.clone()).collect();
        let (provenance, complete) = (self.provenance.clone(), finished.is_some());
        let settled_after = finished.flatten();
        ConfirmationFile { provenance, complete, settled_after, designs }.write(&self.dir)
    }
}
