//! Confirmation of the best designs of a study: `walk.json` beside the journal, not part of the budget.
//!
//! A study searches for the ends of its windows in strides and may step over a gap; an optimizer then favours
//! designs with undetected gaps. An end may also depend on whether a corner catches.
//! Therefore, before a design is recommended,
//!
//! 1. the design with the widest expected firm window is repeated at the ends of its windows, with friction, start
//!    and time step varied ([`firm`](insertion::evaluation::robustness::firm)); this goes on with the next design
//!    until none is likely to improve on the best ([`ask_tell::gp::StoppingCriterion`]);
//! 2. the design that the rule ranks first by the firm windows is walked: its windows are searched again in steps
//!    of 0.1 mm. If they change, their ends are repeated, too, and step 1 may follow again.
//!
//! The recommended design is the walked one that the rule ranks first by the firm windows after the walk. If the
//! study uses the finger stiffnesses of the paper, each walked design is also evaluated once with the
//! stiffnesses computed from its ribs, for comparison only.

use super::rule::{Rank, Rule};
use super::{ByRibs, Provenance, Recorded, Walked, read_analysis};
use insertion::{Evaluation, FirmResult};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

pub(super) const WALK_FILE: &str = "walk.json";

/// Contents of `walk.json`.
#[derive(Serialize, Deserialize)]
pub(super) struct ConfirmationFile {
    /// Provenance; the confirmation is valid for no other.
    pub provenance: Provenance,
    /// Whether the confirmation is complete.
    pub complete: bool,
    /// Number of evaluations after which the search settled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settled_after: Option<u64>,
    /// Confirmed designs, in the order in which they were selected.
    pub designs: Vec<ConfirmedDesign>,
}

/// Confirmation of a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ConfirmedDesign {
    pub evaluation: u64,
    /// Results of the repeats on each task, at the ends that the search found.
    pub firm: Vec<FirmResult>,
    /// The walk, if there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub walked: Option<Walk>,
}

/// Walk of a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Walk {
    /// Evaluations on each task.
    pub tasks: Vec<Evaluation>,
    /// Results of the repeats on each task, at the ends that the walk found.
    pub firm: Vec<FirmResult>,
    /// Evaluations with stiffnesses computed from the ribs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub computed: Option<ByRibs>,
}

impl ConfirmationFile {
    /// Reads the file in `dir`; returns `None` if it is missing, damaged or of another provenance.
    pub fn read(dir: &Path, provenance: Option<&Provenance>) -> Option<ConfirmationFile> {
        let file: ConfirmationFile = read_analysis(dir, WALK_FILE)?;
        provenance?.simulates_like(&file.provenance).then_some(file)
    }

    /// Returns whether the search settled after this number of evaluations.
    pub fn settled(&self, evaluations: usize) -> bool {
        self.settled_after == Some(evaluations as u64)
    }
}

impl Rule<'_> {
    /// Returns the design that the rule ranks first among those with a positive value.
    pub fn first<'a>(&self, current: &'a [Recorded]) -> Option<&'a Recorded> {
        let ranked = current.iter().map(|recorded| (recorded, self.recorded_rank(recorded)));
        let inserting = ranked.filter(|(_, rank)| rank.value().is_some_and(|value| value > 0.0));
        inserting.min_by(|(_, a), (_, b)| self.order(a, b)).map(|(recorded, _)| recorded)
    }
}

/// Returns a confirmed design with the windows of its walk, if there was one, and its rank with its firm windows.
pub(super) fn ranked(rule: &Rule, before: &Recorded, row: &ConfirmedDesign) -> (Recorded, Rank) {
    let (recorded, firm) = match &row.walked {
        None => (before.clone(), &row.firm),
        Some(walk) => (with_windows(rule, before, &walk.tasks), &walk.firm),
    };
    let narrowed = |(task, firm): (&Evaluation, &FirmResult)| Evaluation {
        window: firm.narrowed(&task.window),
        ..task.clone()
    };
    let tasks: Vec<Evaluation> = recorded.tasks.iter().zip(firm).map(narrowed).collect();
    let rank = rule.rank(&recorded, &tasks.iter().collect::<Vec<_>>());
    (recorded, rank)
}

/// Returns the evaluation with the windows of the walk; its results under drawn errors are unchanged.
fn with_windows(rule: &Rule, before: &Recorded, found: &[Evaluation]) -> Recorded {
    let mut recorded = before.clone();
    for (task, walked) in recorded.tasks.iter_mut().zip(found) {
        let (success, robust) = (task.success.take(), task.robust.take());
        *task = Evaluation { success, robust, ..walked.clone() };
    }
    recorded.score = rule.goals.score(&recorded.tasks());
    recorded
}

/// Returns the walked designs, best first, and the firm value of the first objective of every design whose
/// ends were repeated, by evaluation. Both are empty without a complete confirmation.
pub(super) fn confirmed_designs(
    file: Option<ConfirmationFile>,
    rule: &Rule,
    current: &[Recorded],
) -> (Vec<Walked>, BTreeMap<u64, f64>) {
    let (mut walked, mut firm_values) = (Vec::new(), BTreeMap::new());
    for row in file.map_or(Vec::new(), |file| file.designs) {
        let Some(before) = current.iter().find(|r| r.index == row.evaluation) else { continue };
        let (recorded, rank) = ranked(rule, before, &row);
        firm_values.insert(row.evaluation, rank.value().unwrap_or(0.0));
        if let Some(Walk { firm, computed: by_ribs, .. }) = row.walked {
            walked.push((rank, Walked { recorded, firm, by_ribs }));
        }
    }
    walked.sort_by(|(a, _), (b, _)| rule.order(a, b));
    (walked.into_iter().map(|(_, walked)| walked).collect(), firm_values)
}
