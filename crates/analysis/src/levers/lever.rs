//! Results of the lever analysis: the levers with the ranges at both ends, and a summary sentence.

use input::shipped::SPACES;
use insertion::evaluation::INDIFFERENCE_MM;
use insertion::space::is_of_task;
use insertion::{Design, Space};
use serde::{Deserialize, Serialize};

/// Effect of the levers on the range of one finger on one task. The start is taught anew before each range is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Levers {
    /// Name of the task.
    pub task: String,
    /// Design of the finger.
    pub design: Design,
    /// Baseline.
    pub base: Base,
    /// Smallest and largest range over infills, mm.
    #[serde(rename = "infill_range_mm")]
    pub infill: [f64; 2],
    /// The levers, by decreasing effect on the range.
    pub levers: Vec<Lever>,
    /// Names of the levers that were not measured, since the limit on windows was reached.
    pub left_out: Vec<String>,
    /// Number of windows measured.
    pub windows: usize,
}

/// Baseline: the finger with all levers at their current values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Base {
    /// Its range, mm; 0 where no start inserts.
    pub range_mm: f64,
    /// Shift of the taught start from that of the task file, mm.
    pub taught_start_mm: f64,
}

/// Parameter that a user can change, with its bounds and the ranges there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lever {
    /// Name in words: `tilt`.
    pub name: String,
    /// Path of the parameter, as `sets` in `priors/levers.toml` and `priors/bench.toml`.
    pub key: String,
    /// Unit of `value`, `low` and `high`; empty for none.
    pub unit: String,
    /// Current value.
    pub value: f64,
    /// Value at the lower bound; larger than `high` if the bounds are factors on a negative stroke.
    pub low: f64,
    /// Value at the upper bound.
    pub high: f64,
    /// Source of the bounds.
    pub source: String,
    /// Ranges at `low` and at `high`, mm; `None` where no start inserts.
    #[serde(rename = "range_mm")]
    pub ends: [Option<f64>; 2],
}

impl Lever {
    /// Returns the difference between the largest and the smallest range tried, including the baseline, mm.
    pub fn span_mm(&self, base: Base) -> f64 {
        let [first, second] = self.ends.map(|end| end.unwrap_or(0.0));
        let low = base.range_mm.min(first).min(second);
        difference_mm([low, base.range_mm.max(first).max(second)])
    }

    /// Formats a value with its unit: `5°`, `0.2`, `100 mm/s`.
    pub fn amount(&self, value: f64) -> String {
        let space = if self.unit.is_empty() || self.unit == "°" { "" } else { " " };
        format!("{}{space}{}", thousandths(value), self.unit)
    }

    /// Describes the change from the current value to an end, 0 or 1: `5° more tilt`; if the ends differ in sign, so
    /// that both may be larger in magnitude, the value: `-5° of tilt`.
    fn step(&self, end: usize) -> String {
        let to = [self.low, self.high][end];
        if self.low < 0.0 && self.high > 0.0 {
            return format!("{} of {}", self.amount(to), self.name);
        }
        let by = to.abs() - self.value.abs();
        let word = if by < 0.0 { "less" } else { "more" };
        format!("{} {word} {}", self.amount(by.abs()), self.name)
    }
}

/// Start of the paths of parameters that a user sets; the others are uncertain.
const OF_USER: [&str; 4] =
    ["task.strategy.", "task.grip.", "task.opening_chamfer", "finger.material."];
/// Largest number of uncertain parameters that are named.
const UNCERTAIN: usize = 2;
/// Advice if no single lever widens the window.
const TUNE: &str = "Together they were not tried: optimize task tune.";

impl Levers {
    /// Returns whether the shipped space `codesign` varies a lever, the task has all parameters of that space, and the
    /// design does not set any of them already.
    fn is_in_codesign(&self, lever: &Lever) -> bool {
        let codesign = SPACES.iter().find(|space| space.name == "codesign");
        let codesign = codesign.and_then(|space| Space::parse(space.text, space.file).ok());
        let tried = |key: &str| self.levers.iter().any(|lever| lever.key == key);
        let has = |space: Space| {
            let of_task = || space.parameters.iter().filter(|of| is_of_task(&of.key));
            of_task().all(|of| tried(&of.key)) && of_task().any(|of| of.key == lever.key)
        };
        !self.design.changes_task() && codesign.is_some_and(has)
    }

    /// Names the smallest ranges over the parameters that a user does not set, such as friction, smallest first; `None`
    /// if none of them narrows the window.
    pub fn uncertainty(&self) -> Option<String> {
        let of_user = |lever: &&Lever| OF_USER.iter().any(|path| lever.key.starts_with(path));
        let least = |lever: &Lever| {
            let [low, high] = lever.ends.map(|end| end.unwrap_or(0.0));
            let (mm, at) = if high < low { (high, lever.high) } else { (low, lever.low) };
            (mm, format!("{mm:.1} mm with {} {}", lever.name, lever.amount(at)))
        };
        let mut found: Vec<_> =
            self.levers.iter().filter(|lever| !of_user(lever)).map(least).collect();
        found.retain(|(mm, _)| is_relevant(difference_mm([*mm, self.base.range_mm])));
        found.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let texts: Vec<_> = found.into_iter().take(UNCERTAIN).map(|(_, text)| text).collect();
        (!texts.is_empty()).then(|| texts.join(", "))
    }

    /// Names the change besides the infill that widens the window most, in one sentence; effects below 0.3 mm are omitted.
    pub fn sentence(&self) -> String {
        let by = |lever: &Lever, end: usize| {
            difference_mm([self.base.range_mm, lever.ends[end].unwrap_or(0.0)])
        };
        let of = |lever| [0, 1].map(|end| (by(lever, end), lever, end));
        // The first of equal effects.
        let most = self.levers.iter().flat_map(of).reduce(|a, b| if b.0 > a.0 { b } else { a });
        let task = &self.task;
        let Some((by, lever, end)) = most.filter(|(by, ..)| is_relevant(*by)) else {
            return format!("Alone, nothing tried widens {task} by {INDIFFERENCE_MM} mm. {TUNE}");
        };
        let more = if self.is_in_codesign(lever) { "; --space codesign searches it" } else { "" };
        format!("{} widens {task} by {by:.1} mm{more}.", lever.step(end))
    }
}

/// Returns whether a difference of ranges, mm, is at least the indifference.
pub fn is_relevant(by_mm: f64) -> bool {
    by_mm >= INDIFFERENCE_MM
}

/// Returns the second range minus the first, mm, rounded to the 0.1 mm grid.
pub fn difference_mm([first, second]: [f64; 2]) -> f64 {
    ((second - first) * 10.0).round() / 10.0
}

/// Formats a number rounded to thousandths.
pub fn thousandths(value: f64) -> String {
    // Adding 0 turns -0 into 0.
    format!("{}", (value * 1e3).round() / 1e3 + 0.0)
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
