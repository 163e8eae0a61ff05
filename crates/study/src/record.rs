//! A study as it can be read back: its configuration and what it measured.

use super::StudyConfig;
use super::on_bench::OnBench;
use super::provenance::Segment;
use super::time::{is_timestamp, now};
use ask_tell::pareto;
use insertion::evaluation::Evaluation;
use insertion::evaluation::objective::{Goals, Measure, Score};
use insertion::evaluation::robustness::firm::Firm;
use insertion::finger::file::FingerFile;
use insertion::outcome::Outcome;
use insertion::space::Design;
use insertion::surrogate::Prediction;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::Instant;

/// A study read from its folder: all that a report may know of it.
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
    /// Configuration, as asked for.
    pub config: StudyConfig,
    /// Provenance of the evaluations, in their order; the first segment begins at 0.
    pub segments: Vec<Segment>,
    /// Measurements, by index: `evaluations[i].index == i`.
    pub evaluations: Vec<Recorded>,
    /// Records in its journal that another program wrote; they are passed over.
    pub foreign: usize,
    /// Results of the walk of the best designs, best first; empty if they were not walked.
    pub walked: Vec<Walked>,
    /// The finger file, if its fingers were computed.
    pub finger: Option<FingerFile>,
    /// The firm value of the first objective of the designs whose ends were repeated, by evaluation.
    pub firm_values: BTreeMap<u64, f64>,
    /// Prediction of its fingers on the bench from measurements, if there are any.
    pub on_bench: Option<OnBench>,
    /// Whether the search has settled with these evaluations: no design was expected to gain.
    pub settled: bool,
}

/// A design that was measured again.
#[derive(Debug, Clone, PartialEq)]
pub struct Walked {
    /// The evaluation with the windows that the walk found, and the score of those.
    pub recorded: Recorded,
    /// Rest of each window when friction, start and step vary a little.
    pub firm: Vec<Firm>,
    /// Results of the same finger with springs computed from its ribs, where those were others.
    pub by_ribs: Option<ByRibs>,
}

/// A design of the paper's springs, measured once more with those that its ribs give it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ByRibs {
    /// Results of the search on each task.
    Measured(Vec<Evaluation>),
    /// Why it cannot be measured.
    Refused(String),
}

/// One evaluation of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// Place in the study, counted from 0; Optuna's trial number.
    pub index: u64,
    /// Of an asynchronous study the number of its proposal, counted from 0.
    pub proposal: Option<u64>,
    /// The design, in the units its keys carry.
    pub design: Design,
    /// The objectives and constraints; `None` if any of them has no value.
    pub score: Option<Score>,
    /// Stiffness the surrogate predicted for the design, N/m.
    pub stiffness: Prediction,
    /// Simulated measurements on each task, in their order.
    pub tasks: Vec<Evaluation>,
    /// When it was measured; the only part that differs between equal runs.
    pub timing: Timing,
    /// Why its line was refused when it was read: it then counts as diverged.
    pub refused: Option<Refused>,
}

/// A line of a journal whose numbers cannot be those of an evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Refused {
    /// Reason why they are impossible.
    pub problem: &'static str,
    /// The values and violations that the optimizer was told at the time, if any.
    pub(super) told: Option<[Vec<f64>; 2]>,
}

/// When an evaluation was measured and how long that took.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Timing {
    /// Begin, UTC, `YYYY-MM-DDTHH:MM:SS.ffffff`.
    pub datetime_start: String,
    /// End, the same.
    pub datetime_complete: String,
    /// Wall-clock duration, s.
    pub wall_s: f64,
    /// For each task whether its values came from the cache; empty where that is not known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cached: Vec<bool>,
}

impl Timing {
    /// Measures something, and says when.
    pub fn of<T>(measure: impl FnOnce() -> T) -> (T, Timing) {
        let (datetime_start, clock) = (now(), Instant::now());
        let measured = measure();
        let (datetime_complete, wall_s) = (now(), clock.elapsed().as_secs_f64());
        (measured, Timing { datetime_start, datetime_complete, wall_s, cached: Vec::new() })
    }

    /// Reason why it is impossible, if it is.
    pub fn implausible(&self) -> Option<&'static str> {
        let stamps = [&self.datetime_start, &self.datetime_complete];
        let sound = stamps.into_iter().all(|stamp| is_timestamp(stamp))
            && self.wall_s.is_finite()
            && self.wall_s >= 0.0;
        (!sound).then_some("its times are none")
    }
}

impl Recorded {
    /// The value of the first objective, in its unit and sense.
    pub fn value(&self) -> Option<f64> {
        self.score.as_ref()?.values.first().copied()
    }

    /// The objectives of a design that keeps all constraints.
    pub fn feasible(&self) -> Option<&[f64]> {
        self.score.as_ref().filter(|score| score.feasible()).map(|score| &score.values[..])
    }

    /// Measurements on a task, by its place among the tasks.
    pub fn on(&self, task: usize) -> Option<&Evaluation> {
        self.tasks.get(task)
    }

    /// Whether it inserts at the nominal start of a task, by its place among the tasks.
    pub fn inserts_on(&self, task: usize) -> bool {
        self.on(task).is_some_and(|found| found.window.nominal == Outcome::Inserted)
    }

    /// Whether it does on any task.
    pub fn inserts(&self) -> bool {
        (0..self.tasks.len()).any(|task| self.inserts_on(task))
    }

    /// Measurements on each task.
    pub fn tasks(&self) -> Vec<&Evaluation> {
        self.tasks.iter().collect()
    }
}

impl StudyRecord {
    /// Records that reading it passed over, a line each.
    pub fn remarks(&self) -> Vec<String> {
        let refused = self.evaluations.iter().filter_map(|r| Some((r.index, r.refused.as_ref()?)));
        let refused = refused.map(|(index, refused)| {
            format!("evaluation {index} is passed over: {}", refused.problem)
        });
        let foreign = (self.foreign > 0).then(|| {
            format!("records of other programs in the journal, passed over: {}", self.foreign)
        });
        refused.chain(foreign).collect()
    }

    /// The evaluations of the last segment, and of those before it that simulate the same: only they
    /// are of the present model.
    pub fn current(&self) -> &[Recorded] {
        self.evaluations.get(self.first_current() as usize..).unwrap_or_default()
    }

    /// Index of the first of the [`current`](Self::current) evaluations.
    pub fn first_current(&self) -> u64 {
        first_current(&self.segments)
    }

    /// The best of the [`current`](Self::current) evaluations: of those that keep all constraints, none
    /// of them raced, the one with the best first objective.
    pub fn best(&self) -> Option<&Recorded> {
        best(&self.config.goals(), self.current())
    }

    /// The [`current`](Self::current) evaluations that keep all constraints and that no other such one
    /// beats in all objectives, best in the first objective first.
    pub fn front(&self) -> Vec<&Recorded> {
        front(&self.config.goals(), self.current())
    }
}

/// Index of the first evaluation that is of the model of the last segment.
pub(super) fn first_current(segments: &[Segment]) -> u64 {
    let Some(last) = segments.last() else { return 0 };
    let alike = |segment: &&Segment| segment.provenance.simulates_like(&last.provenance);
    segments.iter().rev().take_while(alike).last().map_or(0, |segment| segment.first)
}

/// The evaluation that violates the constraints least, all added up, the earliest of equals:
/// what there is where none keeps them.
pub fn nearest(evaluations: &[Recorded]) -> Option<&Recorded> {
    let violation = |recorded: &Recorded| -> Option<f64> {
        let score = recorded.score.as_ref()?;
        Some(score.violations.iter().map(|violation| violation.max(0.0)).sum())
    };
    let known = evaluations.iter().filter_map(|r| Some((r, violation(r)?)));
    known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(recorded, _)| recorded)
}

/// The volume of a front, and the point above which it is taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    /// In the product of the objectives' units.
    pub hypervolume: f64,
    /// A value for each objective: 0 for what is to be large, the largest value of the study
    /// (of feasible designs or not) for what is to be small.
    pub reference: Vec<f64>,
    /// The hypervolume after each evaluation.
    pub so_far: Vec<f64>,
}

/// The volume that the evaluations which keep all constraints dominate.
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

/// Of the evaluations that keep all constraints, none of them raced, the one with the best first
/// objective (of equals the better in the next, and then the earliest).
pub fn best<'a>(
    goals: &Goals,
    evaluations: impl IntoIterator<Item = &'a Recorded>,
) -> Option<&'a Recorded> {
    let mut best: Option<(&Recorded, &[f64])> = None;
    for recorded in evaluations {
        if let Some(values) = recorded.feasible().filter(|_| !recorded.raced())
            && best.is_none_or(|(_, found)| goals.order(values, found).is_gt())
        {
            best = Some((recorded, values));
        }
    }
    best.map(|(recorded, _)| recorded)
}

/// The evaluations that keep all constraints and that no other such one beats in all
/// objectives, best in the first objective first.
pub fn front<'a>(goals: &Goals, evaluations: &'a [Recorded]) -> Vec<&'a Recorded> {
    let known: Vec<(&Recorded, &[f64])> =
        evaluations.iter().filter_map(|recorded| Some((recorded, recorded.feasible()?))).collect();
    let gains: Vec<Vec<f64>> = known.iter().map(|(_, values)| goals.gains(values)).collect();
    let mut front: Vec<_> = pareto::front(&gains).into_iter().map(|i| known[i]).collect();
    front.sort_by(|(_, a), (_, b)| goals.order(b, a));
    front.into_iter().map(|(recorded, _)| recorded).collect()
}
