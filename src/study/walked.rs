//! The best designs of a study, measured again step by step.
//!
//! A study looks for the ends of its windows in strides, which do not see a gap between two
//! of them; an optimizer then finds just the designs whose gaps are passed over. So before one
//! is recommended the best three are walked. What that finds is kept beside the journal, in
//! `walk.json`, and is no part of the budget.

use super::error::StudyError;
use super::folder::{Study, write_file};
use super::provenance::Provenance;
use super::record::Recorded;
use crate::evaluation::Evaluation;
use crate::evaluation::evaluator::Evaluate;
use crate::evaluation::objective::{Goals, Measure};
use rayon::ThreadPool;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Name of the file.
const WALK_FILE: &str = "walk.json";
/// How many designs are walked.
const COUNT: usize = 3;

/// A design that was measured again.
#[derive(Debug, Clone, PartialEq)]
pub struct Walked {
    /// The evaluation with the windows that the walk found, and the score of those.
    pub recorded: Recorded,
}

#[derive(Serialize, Deserialize)]
struct WalkFile {
    /// What walked: of another provenance it says nothing.
    provenance: Provenance,
    walked: Vec<WalkedRow>,
}

#[derive(Serialize, Deserialize)]
struct WalkedRow {
    evaluation: u64,
    tasks: Vec<Evaluation>,
}

/// Whether the windows of the best designs are to be walked: where they decide.
pub fn decides(goals: &Goals) -> bool {
    matches!(goals.objectives.single(), Some(Measure::Range | Measure::CentredRange))
}

/// The designs to be walked: the best three that insert anywhere, earlier ones first of equals.
fn candidates<'a>(goals: &Goals, current: &'a [Recorded]) -> Vec<&'a Recorded> {
    let first_value = |recorded: &Recorded| recorded.value().unwrap_or(0.0);
    let mut known: Vec<(&Recorded, &[f64])> =
        current.iter().filter_map(|recorded| Some((recorded, recorded.feasible()?))).collect();
    known.retain(|(recorded, _)| first_value(recorded) > 0.0);
    known.sort_by(|(_, a), (_, b)| goals.order(b, a));
    known.into_iter().take(COUNT).map(|(recorded, _)| recorded).collect()
}

/// Walks the best designs of a study, those that were walked before left out, and keeps what
/// that finds. Nothing is kept once `stop` is set.
pub fn walk_best(
    study: &Study,
    walker: &dyn Evaluate,
    pool: &ThreadPool,
    stop: &AtomicBool,
) -> Result<Vec<Walked>, StudyError> {
    let (record, goals) = (study.record(), study.config.goals());
    if !decides(&goals) {
        return Ok(Vec::new());
    }
    let best = candidates(&goals, record.current());
    let known = |index: u64| record.walked.iter().find(|w| w.recorded.index == index);
    let walk = |recorded: &&Recorded| -> Result<WalkedRow, StudyError> {
        let tasks = match known(recorded.index) {
            Some(walked) => walked.recorded.tasks.clone(),
            None => {
                walker
                    .evaluate(&recorded.design)
                    .map_err(|source| StudyError::Impossible {
                        index: recorded.index,
                        design: recorded.design.to_string(),
                        source,
                    })?
                    .tasks
            }
        };
        Ok(WalkedRow { evaluation: recorded.index, tasks })
    };
    let rows = pool.install(|| best.par_iter().map(walk).collect::<Result<Vec<_>, _>>())?;
    if stop.load(Ordering::SeqCst) || rows.is_empty() {
        return Ok(Vec::new());
    }
    let walked = ranked(&goals, record.current(), &rows);
    let file = WalkFile { provenance: study.provenance().clone(), walked: rows };
    let path = study.dir().join(WALK_FILE);
    let text = serde_json::to_string(&file)
        .map_err(|error| StudyError::File { path: path.clone(), problem: error.to_string() })?;
    write_file(&path, &(text + "\n"))?;
    Ok(walked)
}

/// What was walked in `dir` with this provenance, best first; nothing where the file is
/// missing, damaged or of another provenance: it can be made again.
pub(super) fn read(
    dir: &Path,
    goals: &Goals,
    provenance: Option<&Provenance>,
    current: &[Recorded],
) -> Vec<Walked> {
    let text = fs::read_to_string(dir.join(WALK_FILE)).unwrap_or_default();
    match serde_json::from_str::<WalkFile>(&text) {
        Ok(file) if Some(&file.provenance) == provenance => ranked(goals, current, &file.walked),
        _ => Vec::new(),
    }
}

/// The evaluations with the windows of the walk, best first; what was measured under drawn
/// errors stays.
fn ranked(goals: &Goals, current: &[Recorded], rows: &[WalkedRow]) -> Vec<Walked> {
    let apply = |row: &WalkedRow| {
        let before = current.iter().find(|recorded| recorded.index == row.evaluation)?;
        let mut recorded = before.clone();
        for (task, walked) in recorded.tasks.iter_mut().zip(&row.tasks) {
            let (success, robust) = (task.success.take(), task.robust.take());
            *task = Evaluation { success, robust, ..walked.clone() };
        }
        recorded.score = goals.score(&recorded.tasks());
        Some(Walked { recorded })
    };
    let mut walked: Vec<Walked> = rows.iter().filter_map(apply).collect();
    let gain = |walked: &Walked| walked.recorded.feasible().map(<[f64]>::to_vec);
    walked.sort_by(|a, b| match (gain(a), gain(b)) {
        (Some(a), Some(b)) => goals.order(&b, &a),
        (a, b) => b.is_some().cmp(&a.is_some()),
    });
    walked
}
