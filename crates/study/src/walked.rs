//! The best designs of a study, confirmed: walked step by step, and repeated six times at their ends.
//!
//! A study looks for the ends of its windows in strides, which do not see a gap between two
//! of them; an optimizer then finds just the designs whose gaps are passed over. And an end may
//! hang on a corner that catches or not. So before one is recommended
//!
//! 1. the ends of a design are repeated with friction, start and step varied
//!    ([`firm`](insertion::evaluation::robustness::firm)): always of the one whose firm window is
//!    expected to be the widest, while that is likely to gain ([`ask_tell::gp::Outlook`]);
//! 2. the first by the rule on the firm windows is walked; where that gives another window, its ends
//!    are repeated, too, and the first step may be due again.
//!
//! Of those walked the first, by the rule on the firm windows that are left, is recommended. (Studies of
//! version 0.3.0 repeat the first nine and walk the first three of these.) Each that is walked is also
//! measured once with the springs that its ribs give it, if the study has the paper's:
//! that decides nothing, it is said beside.
//! What
//! this finds is kept beside the journal, in `walk.json`, and is no part of the budget.

use super::plausible;
use super::provenance::Provenance;
use super::record::{ByRibs, Recorded, Walked};
use super::rule::{Rule, Standing};
use input::files::{self, LARGEST_OWN};
use insertion::evaluation::robustness::firm::Firm;
use insertion::evaluation::{Evaluation, Window};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

pub(super) const WALK_FILE: &str = "walk.json";
/// How many designs are repeated at their ends.
pub(super) const REPEATED: usize = 9;
/// How many of them are walked.
pub(super) const WALKED: usize = 3;

#[derive(Serialize, Deserialize)]
pub(super) struct WalkFile {
    /// Provenance of the walk: of another it says nothing.
    pub provenance: Provenance,
    /// Whether all was done; if not, it is a beginning to go on from.
    pub complete: bool,
    /// Evaluations with which the search settled, if it has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settled_after: Option<u64>,
    /// The designs, in the order in which they were chosen.
    pub designs: Vec<Row>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Row {
    pub evaluation: u64,
    /// Results of the repeats on each task at the ends that the search had found.
    pub firm: Vec<Firm>,
    /// Results of the walk, if it was walked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub walked: Option<WalkedRow>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct WalkedRow {
    /// Results of the walk on each task.
    pub tasks: Vec<Evaluation>,
    /// Results of the repeats on each task at the ends of the walk.
    pub firm: Vec<Firm>,
    /// Results of the computed finger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub computed: Option<ByRibs>,
}

impl WalkFile {
    /// The file in `dir`; `None` where it is missing, damaged or of another provenance: it can
    /// be made again.
    pub fn read(dir: &Path, provenance: Option<&Provenance>) -> Option<WalkFile> {
        let text = files::read_own(&dir.join(WALK_FILE), LARGEST_OWN).ok()?;
        let file: WalkFile = serde_json::from_str(&text).ok()?;
        let walked = file.designs.iter().filter_map(|row| row.walked.as_ref());
        let doubtful = walked.flat_map(WalkedRow::evaluations).find_map(plausible::implausible);
        let same = provenance.is_some_and(|own| own.simulates_like(&file.provenance));
        (same && doubtful.is_none()).then_some(file)
    }
}

impl WalkedRow {
    fn evaluations(&self) -> impl Iterator<Item = &Evaluation> {
        let by_ribs = match &self.computed {
            Some(ByRibs::Measured(tasks)) => tasks.as_slice(),
            Some(ByRibs::Refused(_)) | None => &[],
        };
        self.tasks.iter().chain(by_ribs)
    }
}

impl Rule<'_> {
    /// The first designs by the rule that insert anywhere.
    pub fn candidates<'a>(&self, current: &'a [Recorded], count: usize) -> Vec<&'a Recorded> {
        let standing = |recorded| (recorded, self.as_recorded(recorded));
        let mut known: Vec<(&Recorded, Standing)> = current.iter().map(standing).collect();
        known.retain(|(_, standing)| standing.value().is_some_and(|value| value > 0.0));
        known.sort_by(|(_, a), (_, b)| self.order(a, b));
        known.into_iter().take(count).map(|(recorded, _)| recorded).collect()
    }

    /// How a design stands with its firm windows.
    pub fn firmly(&self, recorded: &Recorded, firm: &[Firm]) -> Standing {
        let windows = recorded.tasks.iter().zip(firm);
        let windows: Vec<Window> = windows.map(|(task, firm)| firm.of(&task.window)).collect();
        self.standing(recorded, &windows)
    }
}

/// The evaluation with the windows of the walk; what was measured under drawn errors stays.
pub(super) fn with_windows(rule: &Rule, before: &Recorded, found: &[Evaluation]) -> Recorded {
    let mut recorded = before.clone();
    for (task, walked) in recorded.tasks.iter_mut().zip(found) {
        let (success, robust) = (task.success.take(), task.robust.take());
        *task = Evaluation { success, robust, ..walked.clone() };
    }
    recorded.score = rule.goals.score(&recorded.tasks());
    recorded
}

/// Whether the search settled with as many evaluations.
pub(super) fn settled(dir: &Path, provenance: Option<&Provenance>, evaluations: usize) -> bool {
    let file = WalkFile::read(dir, provenance);
    file.and_then(|file| file.settled_after) == Some(evaluations as u64)
}

/// Designs walked, best first, and the firm value of the first objective of every design whose
/// ends were repeated, by evaluation; nothing before all is done.
pub(super) fn read(
    dir: &Path,
    rule: &Rule,
    provenance: Option<&Provenance>,
    current: &[Recorded],
) -> (Vec<Walked>, BTreeMap<u64, f64>) {
    let file = WalkFile::read(dir, provenance).filter(|file| file.complete);
    let (mut walked, mut firm_values) = (Vec::new(), BTreeMap::new());
    for row in file.map_or(Vec::new(), |file| file.designs) {
        let Some(before) = current.iter().find(|r| r.index == row.evaluation) else { continue };
        let standing = match row.walked {
            None => rule.firmly(before, &row.firm),
            Some(WalkedRow { tasks, firm, computed: by_ribs }) => {
                let recorded = with_windows(rule, before, &tasks);
                let standing = rule.firmly(&recorded, &firm);
                walked.push((standing.clone(), Walked { recorded, firm, by_ribs }));
                standing
            }
        };
        firm_values.insert(row.evaluation, standing.value().unwrap_or(0.0));
    }
    walked.sort_by(|(a, _), (b, _)| rule.order(a, b));
    (walked.into_iter().map(|(_, walked)| walked).collect(), firm_values)
}
