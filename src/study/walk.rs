//! Measures the best designs of a study again; why and how is in `walked.rs`.

use super::error::StudyError;
use super::folder::{Study, write_own_file};
use super::provenance::Provenance;
use super::record::{ByRibs, Recorded};
use super::rule::Rule;
use super::walked::{REPEATED, Row, WALK_FILE, WALKED, WalkFile, WalkedRow};
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
    /// Walks a design.
    pub walker: &'a dyn Evaluate,
    /// Measures the computed finger of a design, where the study's fingers are the paper's.
    pub by_ribs: Option<&'a Evaluator>,
    /// Repeats its ends.
    pub evaluator: &'a Evaluator,
    /// Does the measuring.
    pub pool: &'a ThreadPool,
    /// Set when the study is to stop: trials then end at once.
    pub stop: &'a AtomicBool,
    /// Told of each design that is repeated or walked, how many are, and of how many.
    pub done: &'a (dyn Fn(Confirmed, &Recorded, [usize; 2]) + Sync),
}

/// Kind of confirmation of a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Confirmed {
    /// Its ends were repeated.
    Repeated,
    /// It was walked.
    Walked,
}

impl Confirmer<'_> {
    /// Measures the best designs of a study again, what is known of them left out, and keeps what
    /// that finds, each design as it is done.
    ///
    /// # Errors
    /// If a design cannot be simulated, or the file not be written.
    pub fn confirm(&self, study: &Study) -> Result<(), StudyError> {
        let (record, goals) = (study.record(), study.config.goals());
        let rule = Rule { goals: &goals, space: &study.config.space };
        let best = match rule.by_windows() {
            true => rule.candidates(record.current(), REPEATED),
            false => Vec::new(),
        };
        if best.is_empty() {
            return Ok(());
        }
        let (kept, seed) = (Kept::read(study, &best, self.stop), study.config.seed);
        self.each(Confirmed::Repeated, &best, |recorded| match kept.row(recorded) {
            Some(_) => Ok(()),
            None => kept.put(Row {
                evaluation: recorded.index,
                firm: self.firm(recorded, &[], seed)?,
                walked: None,
            }),
        })?;
        let standing =
            |recorded| Some((recorded, rule.firmly(recorded, &kept.row(recorded)?.firm)));
        let mut firm: Vec<_> = best.iter().copied().filter_map(standing).collect();
        firm.sort_by(|(_, a), (_, b)| rule.order(a, b));
        let first: Vec<&Recorded> = firm.into_iter().take(WALKED).map(|(best, _)| best).collect();
        self.each(Confirmed::Walked, &first, |recorded| match kept.row(recorded) {
            Some(row) if row.walked.is_none() => kept.put(self.walk(recorded, row, seed)?),
            _ => Ok(()),
        })?;
        kept.finish()
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

/// The file as it grows. Nothing is kept once `stop` is set: trials may have been skipped.
struct Kept<'a> {
    dir: PathBuf,
    provenance: Provenance,
    stop: &'a AtomicBool,
    /// A place for each of the best designs, in their order.
    rows: Mutex<Vec<(u64, Option<Row>)>>,
}

impl<'a> Kept<'a> {
    /// Known results of these designs.
    fn read(study: &'a Study, best: &[&Recorded], stop: &'a AtomicBool) -> Self {
        let (dir, provenance) = (study.dir().to_owned(), study.provenance().clone());
        let file = WalkFile::read(&dir, Some(&provenance));
        let known = file.map_or(Vec::new(), |file| file.designs);
        let row = |index| known.iter().find(|row| row.evaluation == index).cloned();
        let rows = best.iter().map(|recorded| (recorded.index, row(recorded.index))).collect();
        Kept { dir, provenance, stop, rows: Mutex::new(rows) }
    }

    fn row(&self, recorded: &Recorded) -> Option<Row> {
        let rows = self.rows.lock().unwrap_or_else(PoisonError::into_inner);
        rows.iter().find(|(index, _)| *index == recorded.index)?.1.clone()
    }

    fn put(&self, row: Row) -> Result<(), StudyError> {
        let mut rows = self.rows.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(place) = rows.iter_mut().find(|(index, _)| *index == row.evaluation) {
            place.1 = Some(row);
        }
        self.write(&rows, false)
    }

    fn finish(&self) -> Result<(), StudyError> {
        self.write(&self.rows.lock().unwrap_or_else(PoisonError::into_inner), true)
    }

    fn write(&self, rows: &[(u64, Option<Row>)], complete: bool) -> Result<(), StudyError> {
        if self.stop.load(Ordering::SeqCst) {
            return Ok(());
        }
        let designs = rows.iter().filter_map(|(_, row)| row.clone()).collect();
        let file = WalkFile { provenance: self.provenance.clone(), complete, designs };
        let path = self.dir.join(WALK_FILE);
        let text = serde_json::to_string(&file)
            .map_err(|error| StudyError::File { path: path.clone(), problem: error.to_string() })?;
        write_own_file(&path, &(text + "\n"))
    }
}
