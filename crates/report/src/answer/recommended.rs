//! The recommended design, its windows and its ties.

use super::force::ExcessForce;
use super::start::Start;
use super::ties::Ties;
use super::trust::MeasuredFinger;
use super::{unsteady, words};
use insertion::{Evaluation, FirmResult, Measure};
use study::{ByRibs, Recorded, StudyRecord, Walked};

/// Recommended design of a study. For several tasks, ranges and forces are aggregated, and the windows are intersected.
#[derive(Debug, Clone)]
pub struct Recommended<'a> {
    /// The design with its confirmed evaluation, if it was confirmed.
    pub design: &'a Recorded,
    /// Single objective and its value; `None` for a Pareto front.
    pub objective: Option<(Measure, f64)>,
    /// Range, mm; `None` if the nominal start diverged.
    pub range_mm: Option<f64>,
    /// Both ends of the window, mm.
    pub window_mm: [f64; 2],
    /// Width of the window in which all repeats insert, mm; `None` if the ends were not repeated.
    pub firm_range_mm: Option<f64>,
    /// Both ends of the window in which all repeats insert, mm; `None` also if there is none for a task.
    pub firm_window_mm: Option<[f64; 2]>,
    /// Evaluation on each task.
    pub tasks: Vec<OnTask<'a>>,
    /// Evaluations with the stiffness computed from the finger's ribs; `None` if it was not confirmed, or was evaluated
    /// with such a stiffness already.
    pub by_ribs: Option<&'a ByRibs>,
    /// Position of the start in the firm window or, without one, in the window; `None` for several tasks.
    pub start: Option<Start>,
    /// Designs that tie with the recommended one, or with the best one that is left out; `None` for a Pareto front.
    pub ties: Option<Ties<'a>>,
}

/// Best design, in whose place a tied one is recommended.
#[derive(Debug, Clone)]
pub struct LeftOut<'a> {
    /// The design.
    pub design: &'a Recorded,
    /// Its contact force, which exceeds a limit.
    pub force: ExcessForce,
    /// Its gain in the first objective over the recommended design, in its unit.
    pub gain: f64,
}

/// Recommended design on one task.
#[derive(Debug, Clone, Copy)]
pub struct OnTask<'a> {
    /// Name of the task.
    pub name: &'a str,
    /// Evaluation on the task.
    pub measured: &'a Evaluation,
    /// Result of the repeats at both ends of the window, if they were repeated.
    pub firm: Option<&'a FirmResult>,
}

impl<'a> Recommended<'a> {
    pub(super) fn of(
        record: &'a StudyRecord,
        evaluated: &'a Recorded,
        measured: &[MeasuredFinger],
    ) -> Self {
        let (config, index) = (&record.config, evaluated.index);
        let single = config.objective.single();
        let is_walked = |walked: &&Walked| single.is_some() && walked.recorded.index == index;
        let walked = record.walked.iter().find(is_walked);
        let design = walked.map_or(evaluated, |walked| &walked.recorded);
        let firm = walked.map(|walked| &walked.firm[..]);
        let windows: Option<Vec<[f64; 2]>> =
            firm.and_then(|firm| firm.iter().map(FirmResult::window_mm).collect());
        let on = |(at, (name, measured)): (usize, (&'a str, &'a Evaluation))| OnTask {
            name,
            measured,
            firm: firm.and_then(|firm| firm.get(at)),
        };
        let window_mm = intersection(design.tasks.iter().map(|task| words::ends_mm(&task.window)));
        let firm_window_mm = windows.map(|windows| intersection(windows.into_iter()));
        let start = Start::of(firm_window_mm.unwrap_or(window_mm));
        Recommended {
            design,
            objective: single.zip(design.value()),
            range_mm: record.measure(design, Measure::Range),
            window_mm,
            firm_range_mm: walked.map(|walked| firm_range_mm(record, walked)),
            firm_window_mm,
            tasks: config.tasks().zip(&design.tasks).enumerate().map(on).collect(),
            by_ribs: walked.and_then(|walked| walked.by_ribs.as_ref()),
            start: start.filter(|_| record.config.tasks.len() == 1),
            ties: single.map(|_| Ties::of(record, index, measured)),
        }
    }

    /// Returns the best tied design whose contact force is within the limits in place of one whose force exceeds them, and
    /// the latter. If any of the ties is recommended, the safe choice is named already.
    pub(super) fn within_limits(
        self,
        record: &'a StudyRecord,
        measured: &[MeasuredFinger],
    ) -> (Self, Option<LeftOut<'a>>) {
        let applies = record.on_bench.is_none() && unsteady(record, self.design.index).is_none();
        let ties = self.ties.as_ref().filter(|ties| applies && !ties.any());
        let allowed = ties.and_then(|ties| ties.allowed);
        match allowed.zip(ExcessForce::of(record, &self.design.tasks())) {
            Some(((design, loss), force)) => {
                let allowed = Self::of(record, design, measured);
                let left_out = LeftOut { design: self.design, force, gain: loss };
                (Recommended { ties: self.ties, ..allowed }, Some(left_out))
            }
            None => (self, None),
        }
    }
}

/// Returns the range of a confirmed design in which all repeats insert, aggregated over the tasks, mm.
pub(super) fn firm_range_mm(record: &StudyRecord, walked: &Walked) -> f64 {
    let ranges: Vec<f64> = walked.firm.iter().map(FirmResult::range_mm).collect();
    record.config.goals().aggregate.of(Measure::Range.sense(), &ranges)
}

/// Returns the intersection of windows, mm.
fn intersection(windows: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    windows
        .fold([f64::NEG_INFINITY, f64::INFINITY], |[low, high], [a, b]| [low.max(a), high.min(b)])
}
