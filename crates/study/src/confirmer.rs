//! Simulations that confirm the best designs of a study; see `confirmed.rs`.

use super::confirmed::{ConfirmationFile, ConfirmedDesign, WALK_FILE, Walk, ranked};
use super::record::first_current;
use super::rule::{Rank, Rule};
use super::{ByRibs, CachedEvaluator, Recorded, Study, StudyError, write_analysis};
use ask_tell::Grid;
use ask_tell::gp::{Advice, StoppingCriterion};
use insertion::{DesignError, Evaluate, Evaluation, Evaluator, FirmResult, Search, Template};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Evaluators and settings of the confirmation.
pub struct Confirmer<'a> {
    /// Evaluator that walks windows: it searches them in steps of 0.1 mm.
    pub walker: CachedEvaluator<'a>,
    /// Evaluator with stiffnesses computed from the ribs, if the study uses the stiffnesses published in the paper.
    pub by_ribs: Option<Evaluator>,
    /// Threads of the simulations.
    pub pool: &'a ThreadPool,
    /// Progress callback.
    pub done: Box<OnConfirmed<'a>>,
}

/// Progress callback: confirmation step, design, and how many designs of the batch are done and how many it has.
pub type OnConfirmed<'a> = dyn Fn(ConfirmationStep, &Recorded, [usize; 2]) + Sync + 'a;

/// Step of the confirmation of a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConfirmationStep {
    /// The ends of its windows were repeated with friction, start and time step varied.
    Repeated,
    /// Its windows were walked: searched again in steps of 0.1 mm.
    Walked,
}

/// Number of designs confirmed at a time, independent of the number of threads.
const BATCH: usize = 2;

impl Confirmer<'_> {
    /// Confirms the best designs of a study that has ended, and writes each to the log; `settled` is whether
    /// the search stopped early because no gain was expected.
    ///
    /// # Errors
    /// If a design cannot be simulated, or the log cannot be written.
    pub fn confirm(
        &self,
        study: &Study,
        log: &mut ConfirmationLog,
        settled: bool,
    ) -> Result<(), StudyError> {
        // The confirmation of a settled study is part of its search and is not repeated.
        if !study.config.optimizes_windows() || (settled && study.settled()) {
            return Ok(());
        }
        self.confirm_as_advised(study, log, study.evaluations.len(), false)?;
        if self.stopped() {
            return Ok(());
        }
        log.write(Some(settled.then_some(study.evaluations.len() as u64)))
    }

    /// Returns whether no gain is expected, given the first `told` evaluations. Confirms designs until that is
    /// decided.
    ///
    /// # Errors
    /// If a design cannot be simulated, or the log cannot be written.
    pub fn stagnates(
        &self,
        study: &Study,
        log: &mut ConfirmationLog,
        told: usize,
    ) -> Result<bool, StudyError> {
        Ok(self.confirm_as_advised(study, log, told, true)? == Advice::Settled)
    }

    fn stopped(&self) -> bool {
        self.walker.stop.load(Ordering::SeqCst)
    }

    /// Confirms designs as long as the stopping criterion advises it; returns its last advice.
    fn confirm_as_advised(
        &self,
        study: &Study,
        log: &mut ConfirmationLog,
        told: usize,
        searching: bool,
    ) -> Result<Advice, StudyError> {
        let config = &study.config;
        let rule = Rule::of(config);
        let first = first_current(&study.segments) as usize;
        let current = study.evaluations.get(first..told).unwrap_or_default();
        let ranks: Vec<Rank> = current.iter().map(|found| rule.recorded_rank(found)).collect();
        let grid = Grid::new(config.space.levels());
        let observed = rule.observed(current);
        let mut order: Vec<usize> = (0..current.len()).collect();
        order.sort_by(|&a, &b| rule.order(&ranks[a], &ranks[b]));
        let mut places = vec![0; order.len()];
        order.iter().enumerate().for_each(|(place, &at)| places[at] = place);
        loop {
            let known = |(index, found): (usize, &Recorded)| {
                let row = log.get(found)?;
                let (_, rank) = ranked(&rule, found, row);
                let (value, is_final) = (rank.value().unwrap_or(0.0), row.walked.is_some());
                Some(ask_tell::gp::Confirmed { index, value, is_final })
            };
            let confirmed: Vec<_> = current.iter().enumerate().filter_map(known).collect();
            let criterion =
                StoppingCriterion::new(&grid, &observed, &confirmed, config.indifference_mm);
            let advice = match searching {
                true => criterion.advise(&places, BATCH),
                false => criterion.confirm_only(&places, BATCH),
            };
            let Advice::Confirm(chosen) = &advice else { return Ok(advice) };
            // Without confirmation the results of the search are final.
            if config.conclusion.no_confirm {
                return Ok(Advice::Settled);
            }
            let chosen: Vec<&Recorded> = chosen.iter().map(|&at| &current[at]).collect();
            // In parallel; the results are in order.
            let walking = chosen.iter().any(|found| log.get(found).is_some());
            let step = if walking { ConfirmationStep::Walked } else { ConfirmationStep::Repeated };
            let count = AtomicUsize::new(0);
            let one = |found: &&Recorded| {
                let result = self.confirm_design(found, log, config.seed)?;
                (self.done)(step, found, [count.fetch_add(1, Ordering::Relaxed) + 1, chosen.len()]);
                Ok(result)
            };
            let results: Result<Vec<_>, StudyError> =
                self.pool.install(|| chosen.par_iter().map(one).collect());
            log.add(results?.into_iter().flatten().collect())?;
            if self.stopped() {
                return Ok(Advice::Search);
            }
        }
    }

    /// Confirms a design by one more step: repeats the ends of its windows or, if that was done, walks them. Reuses
    /// a result of an earlier run. Returns the result and whether it is new; `None` after cancellation.
    fn confirm_design(
        &self,
        found: &Recorded,
        log: &ConfirmationLog,
        seed: u64,
    ) -> Result<Option<(ConfirmedDesign, bool)>, StudyError> {
        let earlier = log.earlier.iter().find(|row| row.evaluation == found.index).cloned();
        let row = match (log.get(found), earlier) {
            (None, Some(earlier)) => {
                return Ok(Some((ConfirmedDesign { walked: None, ..earlier }, false)));
            }
            (Some(_), Some(earlier)) if earlier.walked.is_some() => {
                return Ok(Some((earlier, false)));
            }
            (None, None) => {
                let firm = self.firm(found, &[], seed)?;
                ConfirmedDesign { evaluation: found.index, firm, walked: None }
            }
            // Walks the windows of the design and repeats the ends of those that changed.
            (Some(row), _) => {
                let walked = self.walker.evaluate(&found.design, None);
                let tasks = walked
                    .map_err(|source| StudyError::impossible(found.index, &found.design, source))?
                    .tasks;
                let walked = Recorded { tasks: tasks.clone(), ..found.clone() };
                let same = |(before, now): (&Evaluation, &Evaluation)| before.window == now.window;
                let windows = found.tasks.iter().zip(&tasks).zip(&row.firm);
                let as_before: Vec<Option<FirmResult>> =
                    windows.map(|(windows, firm)| same(windows).then_some(*firm)).collect();
                let firm = self.firm(&walked, &as_before, seed)?;
                let computed = self.by_ribs.as_ref().map(|evaluator| {
                    let evaluations = evaluator.evaluate_by(&found.design, |scenario| {
                        evaluator.simulate_or_teach(scenario, Search::default(), self.walker.stop)
                    });
                    match evaluations {
                        Ok(evaluations) => ByRibs::Measured(evaluations.tasks),
                        Err(why) => ByRibs::Refused(why.to_string()),
                    }
                });
                ConfirmedDesign { walked: Some(Walk { tasks, firm, computed }), ..row.clone() }
            }
        };
        // After cancellation trials may have been skipped.
        Ok((!self.stopped()).then_some((row, true)))
    }

    /// Determines the firm window of a design on each task, at whose ends all repeats insert; those in `known` are
    /// reused.
    fn firm(
        &self,
        recorded: &Recorded,
        known: &[Option<FirmResult>],
        seed: u64,
    ) -> Result<Vec<FirmResult>, StudyError> {
        let CachedEvaluator { evaluator, stop, .. } = self.walker;
        let firm_on = |(at, (template, task)): (usize, (&Template, &Evaluation))| {
            if let Some(Some(firm)) = known.get(at) {
                return Ok(*firm);
            }
            let scenario = evaluator.scenario(template, &recorded.design, recorded.stiffness)?;
            Ok(evaluator.firm(&scenario, task, seed, stop)?)
        };
        let tasks = evaluator.templates.iter().zip(&recorded.tasks).enumerate();
        let firm: Result<Vec<FirmResult>, DesignError> = tasks.map(firm_on).collect();
        firm.map_err(|source| StudyError::impossible(recorded.index, &recorded.design, source))
    }
}

/// Log of the confirmed designs, written to `walk.json`.
pub struct ConfirmationLog {
    dir: PathBuf,
    /// Results of an earlier run.
    earlier: Vec<ConfirmedDesign>,
    file: ConfirmationFile,
}

impl ConfirmationLog {
    /// Begins a log; reads the results of an earlier run for reuse.
    pub fn open(study: &Study) -> Self {
        let (dir, provenance) = (study.dir().to_owned(), study.provenance().clone());
        let file = ConfirmationFile::read(&dir, Some(&provenance));
        let earlier = file.map_or(Vec::new(), |file| file.designs);
        let (complete, settled_after, designs) = (false, None, Vec::new());
        let file = ConfirmationFile { provenance, complete, settled_after, designs };
        ConfirmationLog { dir, earlier, file }
    }

    fn get(&self, recorded: &Recorded) -> Option<&ConfirmedDesign> {
        self.file.designs.iter().find(|design| design.evaluation == recorded.index)
    }

    /// Adds or replaces results, each with a flag whether it is new; writes the file if any is new.
    fn add(&mut self, results: Vec<(ConfirmedDesign, bool)>) -> Result<(), StudyError> {
        let any_new = results.iter().any(|(_, new)| *new);
        for (result, _) in results {
            let designs = &mut self.file.designs;
            match designs.iter_mut().find(|design| design.evaluation == result.evaluation) {
                Some(design) => *design = result,
                None => designs.push(result),
            }
        }
        if any_new { self.write(None) } else { Ok(()) }
    }

    /// Writes the file. `finished` is `Some` if the confirmation is complete; it then contains the number of
    /// evaluations after which the search settled, if it did.
    fn write(&mut self, finished: Option<Option<u64>>) -> Result<(), StudyError> {
        self.file.complete = finished.is_some();
        self.file.settled_after = finished.flatten();
        write_analysis(&self.dir, WALK_FILE, &self.file)
    }
}
