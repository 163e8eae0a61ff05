//! T9: the same trials in two engines.
//!
//! Two programs that share no code of their contact physics, given the same scenes,
//! should agree on what goes in. The set of trials is fixed by a rule: of the
//! measured fingers the softest and the stiffest in the direction of compliance,
//! each on every task, started at fixed distances from both ends of the window
//! that the first engine finds, inside and outside, and in its middle.

mod remembered;
mod text;
mod time;

#[cfg(test)]
mod tests;

pub use text::{json, text};
pub use time::{Timing, time, time_json, time_text};

use crate::evaluation::tolerance::{self, Search};
use crate::evaluation::{OffsetStep, Window, grid_mm};
use crate::finger::Finger;
use crate::outcome::Outcome;
use crate::trial::{Rig, Trial};
use rayon::prelude::*;
use remembered::Remembered;
use std::collections::BTreeSet;

/// Share of the trials on which the engines are to agree.
pub const AGREEMENT: f64 = 0.9;
/// Mean difference of the windows' ends that is allowed, mm.
pub const END_DIFFERENCE_MM: f64 = 0.5;

/// Which trials are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Set {
    /// All of them, and the second engine's windows.
    Full,
    /// Far from the ends only, without windows: a few for each task.
    Reduced,
}

impl Set {
    /// Distances from an end on its inner side, grid steps.
    fn inside(self) -> &'static [OffsetStep] {
        match self {
            Set::Full => &[1, 3, 10, 20],
            Set::Reduced => &[10],
        }
    }

    /// The same on its outer side.
    fn outside(self) -> &'static [OffsetStep] {
        match self {
            Set::Full => &[1, 3, 10, 20, 40],
            Set::Reduced => &[20],
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

/// One finger on one task, in both engines.
pub struct Pair<'a> {
    /// Name of the task.
    pub task: String,
    /// What the finger is called.
    pub finger_name: String,
    /// The finger.
    pub finger: Finger,
    /// Where it is tried, in the first engine and in the second.
    pub rigs: [&'a dyn Rig; 2],
}

/// The same trial in both engines.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name of the task.
    pub task: String,
    /// What the finger is called.
    pub finger: String,
    /// Shift of the start, grid steps.
    pub offset: OffsetStep,
    /// From the nearer end of the first engine's window, grid steps; negative inside.
    pub from_end: OffsetStep,
    /// How it ended in both.
    pub outcomes: [Outcome; 2],
    /// Distance of the plug's tip at the end, mm, if both inserted it.
    pub tip_mm: Option<f64>,
}

impl Case {
    /// Whether both inserted the plug, or neither.
    pub fn agrees(&self) -> bool {
        let [first, second] = self.outcomes.map(|outcome| outcome == Outcome::Inserted);
        first == second
    }
}

/// The windows of one finger on one task in both engines.
#[derive(Debug, Clone, PartialEq)]
pub struct Windows {
    /// Name of the task.
    pub task: String,
    /// What the finger is called.
    pub finger: String,
    /// As found by both.
    pub windows: [Window; 2],
}

impl Windows {
    /// Differences of the negative and of the positive end, second less first, mm.
    pub fn differences_mm(&self) -> [f64; 2] {
        let [first, second] = &self.windows;
        [
            grid_mm(second.negative_steps - first.negative_steps),
            grid_mm(second.positive_steps - first.positive_steps),
        ]
    }
}

/// What the two engines made of the set.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CrossCheck {
    /// The trials, by task, finger and offset.
    pub cases: Vec<Case>,
    /// The windows, if the set has them.
    pub windows: Vec<Windows>,
}

impl CrossCheck {
    /// Share of the trials on which the engines agree, 0 to 1.
    pub fn agreement(&self) -> f64 {
        self.cases.iter().filter(|case| case.agrees()).count() as f64 / self.cases.len() as f64
    }

    /// Mean difference of the windows' ends, mm; `None` without windows.
    pub fn end_difference_mm(&self) -> Option<f64> {
        let ends = self.windows.iter().flat_map(Windows::differences_mm);
        let sizes: Vec<f64> = ends.map(f64::abs).collect();
        (!sizes.is_empty()).then(|| sizes.iter().sum::<f64>() / sizes.len() as f64)
    }

    /// Whether both targets are met.
    pub fn passed(&self) -> bool {
        self.agreement() >= AGREEMENT
            && self.end_difference_mm().is_none_or(|by| by <= END_DIFFERENCE_MM)
    }
}

/// Runs the set; in parallel over the pairs, collected in their order.
pub fn run(pairs: &[Pair<'_>], set: Set) -> CrossCheck {
    let results: Vec<_> = pairs.par_iter().map(|pair| run_pair(pair, set)).collect();
    let mut all = CrossCheck::default();
    for (cases, windows) in results {
        all.cases.extend(cases);
        all.windows.extend(windows);
    }
    all
}

fn run_pair(pair: &Pair<'_>, set: Set) -> (Vec<Case>, Option<Windows>) {
    let grasped = pair.rigs.map(|rig| rig.grasp(&pair.finger));
    let [first, second] = grasped.each_ref().map(|grasped| Remembered::new(&**grasped));
    let window = |rig: &Remembered| tolerance::evaluate(rig, &pair.finger, Search::Strides).window;
    let reference = window(&first);
    let case = |offset: OffsetStep| {
        let trials = [&first, &second].map(|rig| rig.at(offset));
        Case {
            task: pair.task.clone(),
            finger: pair.finger_name.clone(),
            offset,
            from_end: from_end(&reference, offset),
            outcomes: trials.each_ref().map(|trial| trial.outcome),
            tip_mm: tip_distance(&trials),
        }
    };
    let cases = set.offsets(&reference).into_iter().map(case).collect();
    let windows = (set == Set::Full).then(|| Windows {
        task: pair.task.clone(),
        finger: pair.finger_name.clone(),
        windows: [reference.clone(), window(&second)],
    });
    (cases, windows)
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
