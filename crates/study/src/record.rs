//! Record of a study: its configuration, evaluations and analyses.

use super::{BenchPrediction, ForceLimits, Provenance, Segment, StudyConfig};
use ask_tell::{Grid, pareto};
use insertion::{
    Design, Evaluation, FingerFile, FirmResult, Goals, Measure, Outcome, Prediction, Score,
};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::Instant;

/// Study read from its folder, the input of a report.
///
/// ```
/// use study::StudyRecord;
///
/// let record = StudyRecord::load("../../tests/fixtures/study".as_ref())?;
/// let best = record.best().expect("a design with a range");
/// assert_eq!((best.design.labelled().as_str(), best.value()),
///     ("infill density 11 %, infill direction 6°", Some(6.7)));
/// # Ok::<(), study::StudyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StudyRecord {
    /// Configuration.
    pub config: StudyConfig,
    /// Segments of equal provenance; the first begins at 0.
    pub segments: Vec<Segment>,
    /// Evaluations, by index: `evaluations[i].index == i`.
    pub evaluations: Vec<Recorded>,
    /// Walked designs (see [`Walked`]), best first.
    pub walked: Vec<Walked>,
    /// Finger file, if the fingers were computed.
    pub finger: Option<FingerFile>,
    /// Limits of the contact force, from task and robot files.
    pub limits: ForceLimits,
    /// First objective with the firm windows (see [`FirmResult`]) of each design whose ends were repeated, by the
    /// index of its evaluation.
    pub firm_values: BTreeMap<u64, f64>,
    /// Bench prediction, if there are measurements.
    pub on_bench: Option<BenchPrediction>,
    /// Index of the evaluation that is nearest to an insertion, if no design inserts, but this one would without
    /// robot stop.
    pub robot_stop: Option<u64>,
    /// Whether the search has settled: no design was expected to improve on the best.
    pub settled: bool,
    /// Whether the best designs are to be confirmed and the confirmation is not complete.
    pub confirmation_due: bool,
}

/// Confirmed design whose windows were walked: searched again in steps of 0.1 mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Walked {
    /// Evaluation and score with the windows of the walk.
    pub recorded: Recorded,
    /// Firm part of each window, under small variations of friction, start and time step.
    pub firm: Vec<FirmResult>,
    /// Evaluations with stiffnesses computed from the ribs, if the study uses the stiffnesses published in the paper.
    pub by_ribs: Option<ByRibs>,
}

/// Evaluations of a design with stiffnesses computed from its ribs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ByRibs {
    /// Evaluation on each task.
    Measured(Vec<Evaluation>),
    /// Reason for which it cannot be simulated.
    Refused(String),
}

/// Evaluation of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// Index in the study, from 0; Optuna's trial number.
    pub index: u64,
    /// Number of the proposal, from 0, in an asynchronous study.
    pub proposal: Option<u64>,
    /// The design, in the units of its keys.
    pub design: Design,
    /// Objectives and constraints; `None` if any of them has no value.
    pub score: Option<Score>,
    /// Stiffness predicted by the surrogate, N/m.
    pub stiffness: Prediction,
    /// Evaluation on each task, in their order.
    pub tasks: Vec<Evaluation>,
    /// Times of the evaluation, the only part that differs between equal runs.
    pub timing: Timing,
}

/// Times of an evaluation.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Timing {
    /// Start, UTC, `YYYY-MM-DDTHH:MM:SS.ffffff`.
    pub datetime_start: String,
    /// End, in the same format.
    pub datetime_complete: String,
    /// Wall-clock duration, s.
    pub wall_s: f64,
    /// For each task whether its values are from the cache; empty if unknown.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cached: Vec<bool>,
}

impl Timing {
    /// Calls `evaluate` and returns its result with start, end and duration.
    pub fn of<T>(evaluate: impl FnOnce() -> T) -> (T, Timing) {
        // The format of Optuna.
        let now = || Timestamp::now().strftime("%Y-%m-%dT%H:%M:%S.%6f").to_string();
        let (datetime_start, clock) = (now(), Instant::now());
        let result = evaluate();
        let (datetime_complete, wall_s) = (now(), clock.elapsed().as_secs_f64());
        (result, Timing { datetime_start, datetime_complete, wall_s, cached: Vec::new() })
    }
}

impl Recorded {
    /// Returns the value of the first objective in its unit; not negated if it is minimized.
    pub fn value(&self) -> Option<f64> {
        self.score.as_ref()?.values.first().copied()
    }

    /// Returns the objectives of a feasible design.
    pub fn feasible(&self) -> Option<&[f64]> {
        self.score.as_ref().filter(|score| score.feasible()).map(|score| &score.values[..])
    }

    /// Returns the evaluation on a task, by the task's index.
    pub fn on(&self, task: usize) -> Option<&Evaluation> {
        self.tasks.get(task)
    }

    /// Returns whether the design inserts at the nominal start of a task, by the task's index.
    pub fn inserts_on(&self, task: usize) -> bool {
        self.on(task).is_some_and(|found| found.window.nominal == Outcome::Inserted)
    }

    /// Returns whether the design inserts at the nominal start of every task.
    pub fn inserts_on_all(&self) -> bool {
        (0..self.tasks.len()).all(|task| self.inserts_on(task))
    }

    /// Returns whether the design inserts at the nominal start of any task.
    pub fn inserts(&self) -> bool {
        (0..self.tasks.len()).any(|task| self.inserts_on(task))
    }

    /// Returns the evaluations on all tasks.
    pub fn tasks(&self) -> Vec<&Evaluation> {
        self.tasks.iter().collect()
    }
}

impl StudyRecord {
    /// Returns whether the search or the confirmation has not ended: it was interrupted, or is running. A polish may
    /// converge at any number of evaluations, so that its end is not known.
    pub fn unfinished(&self) -> bool {
        let StudyRecord { config, segments, evaluations, .. } = self;
        let most = most_evaluations(config, segments, evaluations).min(config.budget);
        let most = most.min(Grid::new(config.space.levels()).size());
        !self.settled && (self.confirmation_due || (evaluations.len() as u64) < most)
    }

    /// Returns the provenance of the last segment.
    pub fn provenance(&self) -> &Provenance {
        self.segments.last().map_or(&self.config.provenance, |segment| &segment.provenance)
    }

    /// Returns the evaluations of the current simulation: of the last segment, and of those directly before it that
    /// simulate alike.
    pub fn current(&self) -> &[Recorded] {
        self.evaluations.get(self.first_current() as usize..).unwrap_or_default()
    }

    /// Returns the index of the first of the [`current`](Self::current) evaluations.
    pub fn first_current(&self) -> u64 {
        first_current(&self.segments)
    }

    /// Returns the feasible [`current`](Self::current) evaluation with the best first objective, without those whose
    /// draws ended early in a race.
    pub fn best(&self) -> Option<&Recorded> {
        best(&self.config.goals(), self.current())
    }

    /// Returns the Pareto front of the feasible [`current`](Self::current) evaluations, best in the first
    /// objective first.
    pub fn front(&self) -> Vec<&Recorded> {
        let goals = self.config.goals();
        let known = |recorded| Some((recorded, Recorded::feasible(recorded)?));
        let known: Vec<(&Recorded, &[f64])> = self.current().iter().filter_map(known).collect();
        let gains: Vec<Vec<f64>> = known.iter().map(|(_, values)| goals.gains(values)).collect();
        let mut front: Vec<_> = pareto::front(&gains).into_iter().map(|i| known[i]).collect();
        front.sort_by(|(_, a), (_, b)| goals.order(b, a));
        front.into_iter().map(|(recorded, _)| recorded).collect()
    }
}

/// Returns the index of the first evaluation that was simulated like the last segment, without another in between.
pub(super) fn first_current(segments: &[Segment]) -> u64 {
    let Some(last) = segments.last() else { return 0 };
    let alike = |segment: &&Segment| segment.provenance.simulates_like(&last.provenance);
    segments.iter().rev().take_while(alike).last().map_or(0, |segment| segment.first)
}

/// Number of current evaluations (see [`StudyRecord::current`]) without an insertion at a nominal start after which a
/// study ends.
pub(super) const MAX_FAILED_STARTS: u64 = 12;

/// Returns the largest number of evaluations: the budget, or fewer while no design has inserted.
pub(super) fn most_evaluations(
    config: &StudyConfig,
    segments: &[Segment],
    evaluations: &[Recorded],
) -> u64 {
    let (budget, first) = (config.evaluations(), first_current(segments));
    match evaluations.iter().skip(first as usize).any(Recorded::inserts) {
        true => budget,
        false => budget.min(first + MAX_FAILED_STARTS),
    }
}

/// Returns the evaluation with the smallest sum of constraint violations, the earliest in a tie.
pub fn nearest(evaluations: &[Recorded]) -> Option<&Recorded> {
    let violation = |recorded: &Recorded| -> Option<f64> {
        Some(recorded.score.as_ref()?.violations.iter().map(|violation| violation.max(0.0)).sum())
    };
    let known = evaluations.iter().filter_map(|r| Some((r, violation(r)?)));
    known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(recorded, _)| recorded)
}

/// Hypervolume of a front.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    /// Hypervolume, in the product of the units of the objectives.
    pub hypervolume: f64,
    /// Reference point: 0 for objectives to maximize, the largest value of the study for those to minimize.
    pub reference: Vec<f64>,
    /// Hypervolume after each evaluation.
    pub so_far: Vec<f64>,
}

/// Returns the hypervolume that the feasible evaluations dominate.
pub fn volume(goals: &Goals, evaluations: &[Recorded]) -> Volume {
    let scores = || evaluations.iter().filter_map(|recorded| recorded.score.as_ref());
    let least = |(i, measure): (usize, &Measure)| match measure.sense() > 0.0 {
        true => 0.0,
        false => scores().filter_map(|score| score.values.get(i).copied()).fold(0.0, f64::max),
    };
    let reference: Vec<f64> = goals.objectives.measures().iter().enumerate().map(least).collect();
    let floor = goals.gains(&reference);
    let (mut archive, mut last) = (pareto::Archive::default(), 0.0);
    let mut step = |recorded: &Recorded| {
        if let Some(values) = recorded.feasible()
            && archive.add(goals.gains(values))
        {
            last = pareto::hypervolume(archive.points(), &floor);
        }
        last
    };
    let so_far: Vec<f64> = evaluations.iter().map(&mut step).collect();
    Volume { hypervolume: last, reference, so_far }
}

/// Returns the feasible evaluation with the best first objective, without those whose draws ended early in a race.
/// Ties are broken by the next objectives, then in favour of the earliest evaluation.
pub fn best<'a>(
    goals: &Goals,
    evaluations: impl IntoIterator<Item = &'a Recorded>,
) -> Option<&'a Recorded> {
    let finished = evaluations.into_iter().filter(|recorded| !recorded.raced());
    let known = finished.filter_map(|recorded| Some((recorded, recorded.feasible()?)));
    let better = known.reduce(|a, b| if goals.order(b.1, a.1).is_gt() { b } else { a });
    better.map(|(recorded, _)| recorded)
}
