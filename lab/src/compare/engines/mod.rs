//! T9: the same trials in two engines.
//!
//! Two engines without common contact code should agree on the outcomes of the same scenes. The
//! trials: of the measured fingers the softest and the stiffest in the direction of compliance, each
//! on every task, started at fixed distances from both ends of the window that the first engine
//! finds, inside and outside, and in its middle.

mod text;
mod time;

#[cfg(test)]
mod tests;

pub use text::{json, text};
pub use time::{time, time_json, time_text};

use super::pairs::{self, WindowPair};
use super::{Subject, TaskWays, Way, each};
use insertion::evaluation::{OffsetStep, Window, tolerance};
use insertion::outcome::Outcome;
use insertion::stiffness::Measurement;
use insertion::trial::Trial;
use std::collections::BTreeSet;

/// Least share of the trials on which the engines agree.
pub const AGREEMENT: f64 = 0.9;
/// Largest mean difference of the windows' ends, mm.
pub const END_DIFFERENCE_MM: f64 = 0.5;

/// Set of trials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrialSet {
    /// All trials, and the second engine's windows.
    Full,
    /// A few trials for each task, far from the ends, without windows.
    Reduced,
}

impl TrialSet {
    /// Distances from an end on its inner and on its outer side, grid steps.
    fn distances(self) -> [&'static [OffsetStep]; 2] {
        match self {
            TrialSet::Full => [&[1, 3, 10, 20], &[1, 3, 10, 20, 40]],
            TrialSet::Reduced => [&[10], &[20]],
        }
    }

    /// Offsets of a window's trials, grid steps, without those inside that are nearer to the other
    /// end.
    pub fn offsets(self, window: &Window) -> Vec<OffsetStep> {
        let [inside, outside] = self.distances();
        let (low, high) = (window.negative_steps, window.positive_steps);
        let middle = (low + high).div_euclid(2);
        let inner = inside.iter().flat_map(|by| {
            let far = 2 * by > high - low;
            [low + by, high - by].into_iter().filter(move |_| !far)
        });
        let outer = outside.iter().flat_map(|by| [low - by, high + by]);
        // Sorted, each once.
        let all: BTreeSet<_> = inner.chain(outer).chain([middle]).collect();
        all.into_iter().collect()
    }
}

/// Trial in both engines.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialPair {
    pub subject: Subject,
    /// Offset of the start, grid steps.
    pub offset: OffsetStep,
    /// Distance beyond the nearer end of the first engine's window, grid steps; negative inside.
    pub from_end: OffsetStep,
    pub outcomes: [Outcome; 2],
    /// Distance of the two tips at the end, mm, if both inserted.
    pub tip_mm: Option<f64>,
}

impl TrialPair {
    /// Whether both inserted the plug, or neither.
    pub fn agrees(&self) -> bool {
        let [first, second] = self.outcomes.map(|outcome| outcome == Outcome::Inserted);
        first == second
    }
}

/// Results of both engines.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CrossCheck {
    /// Trials by task, finger and offset.
    pub trials: Vec<TrialPair>,
    /// Windows, if the set has them.
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

/// Results of the set with the first two ways of every task; in parallel over tasks and fingers.
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
    let pair = || WindowPair::new(subject, ways, [&reference, &ways[1].evaluate(&subject.finger)]);
    CrossCheck { trials, windows: (set == TrialSet::Full).then(pair).into_iter().collect() }
}

/// Distance beyond the nearer end, grid steps.
fn from_end(window: &Window, offset: OffsetStep) -> OffsetStep {
    (window.negative_steps - offset).max(offset - window.positive_steps)
}

/// Distance of the tips at the end of a trial that both inserted, mm.
fn tip_distance(trials: &[Trial; 2]) -> Option<f64> {
    let tip = |trial: &Trial| match trial.outcome {
        Outcome::Inserted => trial.phases.last().map(|end| end.tip_mm),
        _ => None,
    };
    let [a, b] = trials.each_ref().map(tip);
    let square: f64 = a?.iter().zip(b?).map(|(a, b)| (a - b) * (a - b)).sum();
    Some(square.sqrt())
}
