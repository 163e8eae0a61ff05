//! A study as it can be read back: its configuration and what it measured.

use super::StudyConfig;
use crate::evaluation::Evaluation;
use crate::space::Design;
use crate::surrogate::Prediction;

/// A study read from its folder: all that a report may know of it.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyRecord {
    /// What was asked for.
    pub config: StudyConfig,
    /// What was measured, by index: `evaluations[i].index == i`.
    pub evaluations: Vec<Recorded>,
}

/// One evaluation of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// Place in the study, counted from 0; Optuna's trial number.
    pub index: u64,
    /// The design, in the units its keys carry.
    pub design: Design,
    /// The objective, larger is better (for `range` and `centred-range` in mm);
    /// `None` if the evaluation gave no value.
    pub value: Option<f64>,
    /// Stiffness the surrogate predicted for the design, N/m.
    pub stiffness: Prediction,
    /// What the simulation measured.
    pub evaluation: Evaluation,
    /// When it was measured; the only part that differs between equal runs.
    pub timing: Timing,
}

/// When an evaluation was measured and how long that took.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Timing {
    /// Begin, UTC, `YYYY-MM-DDTHH:MM:SS.ffffff`.
    pub datetime_start: String,
    /// End, the same.
    pub datetime_complete: String,
    /// Wall-clock duration, s.
    pub wall_s: f64,
}

impl StudyRecord {
    /// The evaluation with the largest value, the earliest of equals.
    pub fn best(&self) -> Option<&Recorded> {
        best(&self.evaluations)
    }
}

/// The evaluation with the largest value, the earliest of equals.
pub fn best(evaluations: &[Recorded]) -> Option<&Recorded> {
    let mut best: Option<(&Recorded, f64)> = None;
    for recorded in evaluations {
        if let Some(value) = recorded.value
            && best.is_none_or(|(_, found)| value > found)
        {
            best = Some((recorded, value));
        }
    }
    best.map(|(recorded, _)| recorded)
}
