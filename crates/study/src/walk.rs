//! Measures the best designs of a study again; why and how is in `walked.rs`.

use super::config::{Confirmation, StudyConfig};
use super::error::StudyError;
use super::folder::{Study, write_own_file};
use super::provenance::Provenance;
use super::record::{ByRibs, Recorded};
use super::rule::{Rule, Standing};
use super::walked::{REPEATED, Row, WALK_FILE, WALKED, WalkFile, WalkedRow, with_windows};
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
use std::sync::{Mutex, PoisonError};

/// Means of measuring the best designs.
pub struct Confirmer<'a> {
    pub walker: &'a dyn Evaluate,
    /// Measures the computed finger of a design, where the study's fingers are the paper's.
    pub by_ribs: Option<&'a Evaluator>,
    pub evaluator: &'a Evaluator,
    pub pool: &'a ThreadPool,
    /// Set when the study is to stop: trials then end at once.
    pub stop: &'a AtomicBool,
    pub no_confirm: bool,
    /// Told of each design that is repeated or walked, how many are, and of how many.
    pub done: &'a (dyn Fn(Confirmed, &Recorded, [usize; 2]) + Sync),
}

/// Kind of confirmation of a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Confirmed {
    Repeated,
    Walked,
}

/// Returns the least gain over the best confirmed design that counts.
pub(super) fn gain(config: &StudyConfig) -> Gain {
    let (least, noise_floor) = (config.indifference_mm, DEFAULT_NOISE_FLOOR);
    Gain { least, probability: 0.02, noise_floor, floor: 0.0 }
}

/// Designs confirmed at a time, whatever the number of threads.
const AT_ONCE: usize = 2;

impl Confirmer<'_> {
    /// Confirms what a study has to confirm that has ended, and keeps it, each design as it is done;
    /// and whether it has `settled`.
    ///
    /// # Errors
    /// If a design cannot be simulated, or the file not be written.
    pub fn confirm(&self, study: &Study, kept: &Kept, settled: bool) -> Result<(), StudyError> {
        let goals = study.config.goals();
        let rule = Rule { goals: &goals, space: &study.config.space };
        // What confirmed a settled study was chosen as it went, and is not chosen again.
        if !rule.by_windows() || (settled && study.settled()) {
            return Ok(());
        }
        match study.config.confirmation {
            Confirmation::Expected => {
                self.by_expectation(study, kept, study.evaluations.len(), false)?;
            }
            Confirmation::NineAndThree => self.nine_and_three(study, kept, &rule)?,
        }
        if self.stop.load(Ordering::SeqCst) {
            return Ok(());
        }
        kept.finish(settled.then_some(study.evaluations.len() as u64))
    }

    /// Whether no gain is expected of a study that settles after its first `told` evaluations, what
    /// has to be confirmed to say so confirmed.
    ///
    /// # Errors
    /// As [`confirm`](Self::confirm).
    pub fn judge(&self, study: &Study, kept: &Kept, told: usize) -> Result<bool, StudyError> {
        Ok(self.by_expectation(study, kept, told, true)? == Advice::Settled)
    }

    fn by_expectation(
        &self,
        study: &Study,
        kept: &Kept,
        told: usize,
        searching: bool,
    ) -> Result<Advice, StudyError> {
        let (record, goals, seed) = (study.record(), study.config.goals(), study.config.seed);
        let rule = Rule { goals: &goals, space: &study.config.space };
        let current = record.current();
        let current =
            &current[..told.saturating_sub(record.first_current() as usize).min(current.len())];
        let standings: Vec<Standing> =
            current.iter().map(|found| rule.as_recorded(found)).collect();
        let space = &study.config.space;
        let grid = Grid::new(space.levels());
        let observed = rule.observed(current);
        let mut order: Vec<usize> = (0..current.len()).collect();
        order.sort_by(|&a, &b| rule.order(&standings[a], &standings[b]));
        let mut rank = vec![0; order.len()];
        order.iter().enumerate().for_each(|(place, &at)| rank[at] = place);
        loop {
            let known = |(at, found): (usize, &Recorded)| {
                let row = kept.row(found)?;
                Some(ask_tell::gp::Confirmed {
                    at,
                    value: standing(&rule, found, &row).value().unwrap_or(0.0),
                    last: row.walked.is_some(),
                })
            };
            let confirmed: Vec<_> = current.iter().enumerate().filter_map(known).collect();
            let outlook = Outlook::new(&grid, &observed, &confirmed, gain(&study.config));
            let advice = match searching {
                true => outlook.advise(&rank, AT_ONCE),
                false => outlook.confirm_only(&rank, AT_ONCE),
            };
            let Advice::Confirm(places) = &advice else { return Ok(advice) };
            // Without confirmations what the search found stands for them.
            if self.no_confirm {
                return Ok(Advice::Settled);
            }
            let chosen: Vec<&Recorded> = places.iter().map(|&at| &current[at]).collect();
            let walking = chosen.iter().any(|found| kept.row(found).is_some());
            let phase = if walking { Confirmed::Walked } else { Confirmed::Repeated };
            kept.want(&chosen);
            self.each(phase, &chosen, |found| self.further(found, kept, seed))?;
            if self.stop.load(Ordering::SeqCst) {
                return Ok(Advice::Search);
            }
        }
    }

    /// Repeats a design, or walks one that was repeated; what is known is not measured again.
    fn further(&self, found: &Recorded, kept: &Kept, seed: u64) -> Result<(), StudyError> {
        let known = kept.known.iter().find(|row| row.evaluation == found.index).cloned();
        match (kept.row(found), known) {
            (None, Some(known)) => kept.recall(Row { walked: None, ..known }),
            (None, None) => {
                let firm = self.firm(found, &[], seed)?;
                return self.keep(kept, Row { evaluation: found.index, firm, walked: None });
            }
            (Some(_), Some(known)) if known.walked.is_some() => kept.recall(known),
            (Some(row), _) => return self.keep(kept, self.walk(found, row, seed)?),
        }
        Ok(())
    }

    /// Keeps a result, unless trials may have been skipped for it.
    fn keep(&self, kept: &Kept, row: Row) -> Result<(), StudyError> {
        if self.stop.load(Ordering::SeqCst) { Ok(()) } else { kept.put(row) }
    }

    /// The rule of version 0.3.0.
    fn nine_and_three(&self, study: &Study, kept: &Kept, rule: &Rule) -> Result<(), StudyError> {
        let (record, seed) = (study.record(), study.config.seed);
        let best = rule.candidates(record.current(), REPEATED);
        kept.want(&best);
        self.each(Confirmed::Repeated, &best, |found| self.further(found, kept, seed))?;
        let standing = |found| Some((found, rule.firmly(found, &kept.row(found)?.firm)));
        let mut firm: Vec<_> = best.iter().copied().filter_map(standing).collect();
        firm.sort_by(|(_, a), (_, b)| rule.order(a, b));
        let first: Vec<&Recorded> = firm.into_iter().take(WALKED).map(|(best, _)| best).collect();
        self.each(Confirmed::Walked, &first, |found| self.further(found, kept, seed))
    }

    /// Does something with each design, several at a time.
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

    /// The design walked, and repeated at those ends that are others than before.
    fn walk(&self, searched: &Recorded, row: Row, seed: u64) -> Result<Row, StudyError> {
        let found = self.walker.evaluate(&searched.design);
        let tasks = found.map_err(|source| impossible(searched, source))?.tasks;
        let mut walked = searched.clone();
        let same = |(before, now): (&Evaluation, &Evaluation)| before.window == now.window;
        let windows = searched.tasks.iter().zip(&tasks).zip(&row.firm);
        let as_before: Vec<Option<Firm>> =
            windows.map(|(windows, firm)| same(windows).then_some(*firm)).collect();
        walked.tasks.clone_from(&tasks);
        let firm = self.firm(&walked, &as_before, seed)?;
        let computed = self.by_ribs.map(|evaluator| self.computed(evaluator, &searched.design));
        Ok(Row { walked: Some(WalkedRow { tasks, firm, computed }), ..row })
    }

    /// The windows of a design with springs computed from its ribs.
    fn computed(&self, evaluator: &Evaluator, design: &Design) -> ByRibs {
        let measured = evaluator.evaluate_by(design, |specimen| {
            evaluator.measure_or_teach(specimen, Search::default(), &Plan::WINDOW, self.stop)
        });
        match measured {
            Ok(found) => ByRibs::Measured(found.tasks),
            Err(why) => ByRibs::Refused(why.to_string()),
        }
    }

    /// The firm windows of a design on all tasks, those that are known left out.
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
        firm.map_err(|source| impossible(recorded, source))
    }
}

fn impossible(recorded: &Recorded, source: Impossible) -> StudyError {
    StudyError::Impossible { index: recorded.index, design: recorded.design.to_string(), source }
}

/// How a design stands with what confirmed it.
fn standing(rule: &Rule, found: &Recorded, row: &Row) -> Standing {
    match &row.walked {
        None => rule.firmly(found, &row.firm),
        Some(walked) => rule.firmly(&with_windows(rule, found, &walked.tasks), &walked.firm),
    }
}

/// The file as it grows.
pub struct Kept {
    dir: PathBuf,
    provenance: Provenance,
    /// Lines of the file: measured again they would be the same.
    known: Vec<Row>,
    /// A place for each design that was chosen, in that order.
    rows: Mutex<Vec<(u64, Option<Row>)>>,
}

impl Kept {
    /// Reads the confirmations of a study, before any is chosen.
    pub fn read(study: &Study) -> Self {
        let (dir, provenance) = (study.dir().to_owned(), study.provenance().clone());
        let file = WalkFile::read(&dir, Some(&provenance));
        let known = file.map_or(Vec::new(), |file| file.designs);
        Kept { dir, provenance, known, rows: Mutex::default() }
    }

    /// Gives these designs a place, those that have none.
    fn want(&self, chosen: &[&Recorded]) {
        let mut rows = self.rows.lock().unwrap_or_else(PoisonError::into_inner);
        for found in chosen {
            if !rows.iter().any(|(index, _)| *index == found.index) {
                rows.push((found.index, None));
            }
        }
    }

    fn row(&self, recorded: &Recorded) -> Option<Row> {
        let rows = self.rows.lock().unwrap_or_else(PoisonError::into_inner);
        rows.iter().find(|(index, _)| *index == recorded.index)?.1.clone()
    }

    fn set(rows: &mut [(u64, Option<Row>)], row: Row) {
        if let Some(place) = rows.iter_mut().find(|(index, _)| *index == row.evaluation) {
            place.1 = Some(row);
        }
    }

    fn recall(&self, row: Row) {
        Self::set(&mut self.rows.lock().unwrap_or_else(PoisonError::into_inner), row);
    }

    fn put(&self, row: Row) -> Result<(), StudyError> {
        let mut rows = self.rows.lock().unwrap_or_else(PoisonError::into_inner);
        Self::set(&mut rows, row);
        self.write(&rows, None)
    }

    fn finish(&self, settled_after: Option<u64>) -> Result<(), StudyError> {
        let rows = self.rows.lock().unwrap_or_else(PoisonError::into_inner);
        self.write(&rows, Some(settled_after))
    }

    /// Writes the file; of what is `finished` also with how many evaluations it settled, if it did.
    fn write(
        &self,
        rows: &[(u64, Option<Row>)],
        finished: Option<Option<u64>>,
    ) -> Result<(), StudyError> {
        let designs = rows.iter().filter_map(|(_, row)| row.clone()).collect();
        let (provenance, complete) = (self.provenance.clone(), finished.is_some());
        let settled_after = finished.flatten();
        let file = WalkFile { provenance, complete, settled_after, designs };
        let path = self.dir.join(WALK_FILE);
        let text = serde_json::to_string(&file)
            .map_err(|error| StudyError::File { path: path.clone(), problem: error.to_string() })?;
        write_own_file(&path, &(text + "\n"))
    }
}
