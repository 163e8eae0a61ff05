//! The best designs of a study, measured again step by step.
//!
//! A study looks for the ends of its windows in strides, which do not see a gap between two
//! of them; an optimizer then finds just the designs whose gaps are passed over. So before one
//! is recommended the best three are walked. What that finds is kept beside the journal, in
//! `walk.json`, and is no part of the budget.

use super::provenance::Provenance;
use super::record::{Recorded, Walked};
use crate::evaluation::Evaluation;
use crate::evaluation::objective::{Goals, Measure};
use crate::files::{self, LARGEST_OWN};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the file.
pub(super) const WALK_FILE: &str = "walk.json";
/// How many designs are walked.
const COUNT: usize = 3;

#[derive(Serialize, Deserialize)]
pub(super) struct WalkFile {
    /// What walked: of another provenance it says nothing.
    pub provenance: Provenance,
    /// The designs that were walked.
    pub walked: Vec<WalkedRow>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct WalkedRow {
    /// Index of the evaluation.
    pub evaluation: u64,
    /// What the walk found on each task.
    pub tasks: Vec<Evaluation>,
}

/// Whether the windows of the best designs are to be walked: where they decide.
pub(super) fn decides(goals: &Goals) -> bool {
    matches!(goals.objectives.single(), Some(Measure::Range | Measure::CentredRange))
}

/// The designs to be walked: the best three that insert anywhere, earlier ones first of equals.
pub(super) fn candidates<'a>(goals: &Goals, current: &'a [Recorded]) -> Vec<&'a Recorded> {
    let first_value = |recorded: &Recorded| recorded.value().unwrap_or(0.0);
    let mut known: Vec<(&Recorded, &[f64])> =
        current.iter().filter_map(|recorded| Some((recorded, recorded.feasible()?))).collect();
    known.retain(|(recorded, _)| first_value(recorded) > 0.0);
    known.sort_by(|(_, a), (_, b)| goals.order(b, a));
    known.into_iter().take(COUNT).map(|(recorded, _)| recorded).collect()
}

/// What was walked in `dir` with this provenance, best first; nothing where the file is
/// missing, damaged or of another provenance: it can be made again.
pub(super) fn read(
    dir: &Path,
    goals: &Goals,
    provenance: Option<&Provenance>,
    current: &[Recorded],
) -> Vec<Walked> {
    let text = files::read_own(&dir.join(WALK_FILE), LARGEST_OWN).unwrap_or_default();
    match serde_json::from_str::<WalkFile>(&text) {
        Ok(file) if Some(&file.provenance) == provenance => ranked(goals, current, &file.walked),
        _ => Vec::new(),
    }
}

/// The evaluations with the windows of the walk, best first; what was measured under drawn
/// errors stays.
pub(super) fn ranked(goals: &Goals, current: &[Recorded], rows: &[WalkedRow]) -> Vec<Walked> {
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
