//! Windows of the same fingers in two ways: how far their ends lie apart.

use super::{Subject, TaskWays, Way, each, subject_json, window_json, window_words};
use finger_opt::calibration::statistics::mean;
use insertion::evaluation::{OffsetStep, Window, grid_mm};
use insertion::stiffness::Measurement;
use serde_json::{Value, json};
use std::fmt::Write;

/// The windows of one finger in two ways.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowPair {
    /// The finger and its task.
    pub subject: Subject,
    /// What the two ways are called.
    pub ways: [String; 2],
    /// The windows found.
    pub windows: [Window; 2],
    /// Trials run for them.
    pub trials: [u32; 2],
}

impl WindowPair {
    /// How far the negative and the positive end lie farther out the second way, mm.
    pub fn moved_mm(&self) -> [f64; 2] {
        self.moved().map(grid_mm)
    }

    fn moved(&self) -> [OffsetStep; 2] {
        let [first, second] = &self.windows;
        [first.negative_steps - second.negative_steps, second.positive_steps - first.positive_steps]
    }

    /// Whether the nominal start ends alike and no end moves by more than so many grid steps.
    pub fn agrees(&self, allowed: OffsetStep) -> bool {
        self.windows[0].nominal == self.windows[1].nominal
            && self.moved().iter().all(|moved| moved.abs() <= allowed)
    }
}

/// Measures every design on every task in all ways: one pair for each way but the first.
pub fn measure(tasks: &[TaskWays], designs: &[Measurement]) -> Vec<WindowPair> {
    let pairs = each(tasks, designs, |subject, ways| {
        let Some((first, others)) = ways.split_first() else { return Vec::new() };
        let reference = first.evaluate(&subject.finger);
        let pair = |other: &Way| {
            let found = other.evaluate(&subject.finger);
            WindowPair {
                subject: subject.clone(),
                ways: [first, other].map(|way| way.name.clone()),
                windows: [reference.window.clone(), found.window],
                trials: [reference.trials, found.trials],
            }
        };
        others.iter().map(pair).collect()
    });
    pairs.concat()
}

/// Mean distance between the ends of the same windows, mm; `None` without pairs.
pub fn mean_end_difference_mm(pairs: &[WindowPair]) -> Option<f64> {
    let ends = pairs.iter().flat_map(WindowPair::moved_mm).map(f64::abs);
    mean(&ends.collect::<Vec<_>>())
}

/// An aligned table at most 80 columns wide, and a line about all pairs; with a verdict on
/// each if the ends may move by so many grid steps only.
pub fn text(pairs: &[WindowPair], allowed: Option<OffsetStep>) -> String {
    let first = pairs.first().map_or("", |pair| &pair.ways[0]);
    let mut text = format!(
        "{:<5}{:>4} {:>11}  {:<14}{:>14}{:>14}{:>10}\n{:36}{:>14}{:>14}{:>10}\n",
        "task", "no.", "infill", "compared", first, "its window", "ends move", "", "mm", "mm", "mm"
    );
    for pair in pairs {
        let [below, above] = pair.moved_mm();
        let [a, b] = pair.windows.each_ref().map(window_words);
        let verdict = match allowed.map(|allowed| pair.agrees(allowed)) {
            None => "",
            Some(true) => " ok",
            Some(false) => " FAIL",
        };
        let design = &pair.subject.design;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<5}{:>4} {:>11}  {:<14}{a:>14}{b:>14}{below:>+5.1}{above:>+5.1}{verdict}",
            pair.subject.task,
            design.design,
            pair.subject.infill(),
            pair.ways[1],
        );
    }
    text + &summary(pairs)
}

/// How many pairs are the same, how far the ranges differ, and what it cost.
fn summary(pairs: &[WindowPair]) -> String {
    let differences: Vec<f64> = pairs
        .iter()
        .map(|pair| (pair.windows[0].range_mm() - pair.windows[1].range_mm()).abs())
        .collect();
    let trials = |way: usize| pairs.iter().map(|pair| pair.trials[way]).sum::<u32>();
    format!(
        "same ends in {} of {}; ranges differ by {:.2} mm in the mean, {:.1} mm at most\n\
         trials: {} against {}\n",
        pairs.iter().filter(|pair| pair.agrees(0)).count(),
        pairs.len(),
        mean(&differences).unwrap_or(0.0),
        differences.iter().copied().fold(0.0, f64::max),
        trials(0),
        trials(1),
    )
}

/// The same for programs: a list with the keys `way` for the name of the second way, and
/// `windows` for the two windows; a verdict if the ends may move by so many grid steps only.
pub fn json(
    pairs: &[WindowPair],
    allowed: Option<OffsetStep>,
    way: &str,
    windows: [&str; 2],
) -> Vec<Value> {
    let row = |pair: &WindowPair| {
        let [below, above] = pair.moved_mm();
        let [first, second] = pair.windows.each_ref().map(window_json);
        let measured = json!({
            way: pair.ways[1],
            windows[0]: first,
            windows[1]: second,
            "trials": pair.trials,
            "negative_moved_mm": below,
            "positive_moved_mm": above,
            "allowed_mm": allowed.map(grid_mm),
            "passed": allowed.map(|allowed| pair.agrees(allowed)),
        });
        subject_json(&pair.subject.task, &pair.subject.design, measured)
    };
    pairs.iter().map(row).collect()
}
