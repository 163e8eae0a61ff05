//! T9: the same trials in two engines.
//!
//! Two programs that share no code of their contact physics, given the same scenes,
//! should agree on what goes in. The set of trials is fixed by a rule: of the
//! measured fingers the softest and the stiffest in the direction of compliance,
//! each on every task, started at fixed distances from both ends of the window
//! that the first engine finds, inside and outside, and in its middle.

mod text;
mod time;

#[cfg(test)]
mod tests;

pub use text::{json, text};
pub use time::{Timing, time, time_json, time_text};

use super::pairs::{self, WindowPair};
use super::{Subject, TaskWays, Way, each};
use insertion::evaluation::{OffsetStep, Window, tolerance};
use insertion::outcome::Outcome;
use insertion::stiffness::Measurement;
use insertion::trial::Trial;
use std::collections::BTreeSet;

/// Share of the trials on which the engines are to agree.
pub const AGREEMENT: f64 = 0.9;
/// Mean difference of the windows' ends that is allowed, mm.
pub const END_DIFFERENCE_MM: f64 = 0.5;

/// Which trials are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrialSet {
    /// All of them, and the second engine's windows.
    Full,
    /// Far from the ends only, without windows: a few for each task.
    Reduced,
}

impl TrialSet {
    /// Distances from an end on its inner side, grid steps.
    fn inside(self) -> &'static [OffsetStep] {
        match self {
            TrialSet::Full => &[1, 3, 10, 20],
            TrialSet::Reduced => &[10],
        }
    }

    /// The same on its outer side.
    fn outside(self) -> &'static [OffsetStep] {
        match self {
            TrialSet::Full => &[1, 3, 10, 20, 40],
            TrialSet::Reduced => &[20],
        }
    }

    /// The offsets of a window's trials, grid steps: those inside that are nearer to
    /// the other end are left out, since they belong to that.
    pub fn offsets(self, window: &Window) -> Vec<OffsetStep> {
        let (low, high) = (window.negative_steps, window.positive_steps);
        let middle = (low + high).div_euclid(2);
        let inner = self.inside().iter().flat_map(|by| {
            let far = 2 * by > high - low;
            [low + by, high - by].into_iter().filter(move |_| !far)
        });
        let outer = self.outside().iter().flat_map(|by| [low - by, high + by]);
        // Sorted, each once.
        let all: BTreeSet<_> = inner.chain(outer).chain([middle]).collect();
        all.into_iter().collect()
    }
}

/// The same trial in both engines.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialPair {
    /// The finger and its task.
    pub subject: Subject,
    /// Shift of the start, grid steps.
    pub offset: OffsetStep,
    /// From the nearer end of the first engine's window, grid steps; negative inside.
    pub from_end: OffsetStep,
    /// How it ended in both.
    pub outcomes: [Outcome; 2],
    /// Distance of the plug's tip at the end, mm, if both inserted it.
    pub tip_mm: Option<f64>,
}

impl TrialPair {
    /// Whether both inserted the plug, or neither.
    pub fn agrees(&self) -> bool {
        let [first, second] = self.outcomes.map(|outcome| outcome == Outcome::Inserted);
        first == second
    }
}

/// What the two engines made of the set.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CrossCheck {
    /// The trials, by task, finger and offset.
    pub trials: Vec<TrialPair>,
    /// The windows, if the set has them.
    pub windows: Vec<WindowPair>,
}

impl CrossCheck {
    /// Share of the trials on which the engines agree, 0 to 1.
    pub fn agreement(&self) -> f64 {
        self.trials.iter().filter(|pair| pair.agrees()).count() as f64 / self.trials.len() as f64
    }

    /// Mean difference of the windows' ends, mm; `None` without windows.
    pub fn end_difference_mm(&self) -> Option<f64> {
        pairs::mean_end_difference_mm(&self.windows)
    }

    /// Whether both targets are met.
    pub fn passed(&self) -> bool {
        self.agreement() >= AGREEMENT
            && self.end_difference_mm().is_none_or(|by| by <= END_DIFFERENCE_MM)
    }
}

/// Runs the set with the first two ways of every task; in parallel over tasks and fingers.
pub fn run(tasks: &[TaskWays], designs: &[Measurement], set: TrialSet) -> CrossCheck {
    let results = each(tasks, designs, |subject, ways| match ways {
        [first, second, ..] => in_both(subject, [first, second], set),
        _ => CrossCheck::default(),
    });
    let mut all = CrossCheck::default();
    for result in results {
        all.trials.extend(result.trials);
        all.windows.extend(result.windows);
    }
    all
}

fn in_both(subject: &Subject, ways: [&Way; 2], set: TrialSet) -> CrossCheck {
    let reference = ways[0].evaluate(&subject.finger);
    let grasped = ways.map(|way| way.rig.grasp(&subject.finger));
    let trial = |offset: OffsetStep| {
        let trials = grasped.each_ref().map(|grasped| grasped.trial(tolerance::offset(offset)));
        TrialPair {
            subject: subject.clone(),
            offset,
            from_end: from_end(&reference.window, offset),
            outcomes: trials.each_ref().map(|trial| trial.outcome),
            tip_mm: tip_distance(&trials),
        }
    };
    let trials = set.offsets(&reference.window).into_iter().map(trial).collect();
    let pair = || {
        let second = ways[1].evaluate(&subject.finger);
        WindowPair {
            subject: subject.clone(),
            ways: ways.map(|way| way.name.clone()),
            trials: [reference.trials, second.trials],
            windows: [reference.window, second.window],
        }
    };
    CrossCheck { trials, windows: (set == TrialSet::Full).then(pair).into_iter().collect() }
}

/// Beyond the nearer end, grid steps.
fn from_end(window: &Window, offset: OffsetStep) -> OffsetStep {
    (window.negative_steps - offset).max(offset - window.positive_steps)
}

/// Between the tips at the end of a trial that both inserted, mm.
fn tip_distance(trials: &[Trial; 2]) -> Option<f64> {
    if trials.iter().any(|trial| trial.outcome != Outcome::Inserted) {
        return None;
    }
    let [a, b] = trials.each_ref().map(|trial| trial.phases.last().map(|end| end.tip_mm));
    let square: f64 = a?.iter().zip(b?).map(|(a, b)| (a - b) * (a - b)).sum();
    Some(square.sqrt())
}
