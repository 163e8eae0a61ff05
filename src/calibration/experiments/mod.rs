//! Measurements from a bench: `measurements.csv` (`docs/guide/measuring.md`) to checked experiments.
//!
//! Only the task, the design and something that was measured are needed; columns may be left
//! out, and further design parameters are further columns, named as in a space file.

mod cell;
mod column;
mod line;
mod problem;
#[cfg(test)]
mod tests;
mod write;

pub use column::{COLUMNS, Column};
pub use problem::{Problem, Problems};
pub use write::appended;

use insertion::outcome::FailureClass;
use insertion::space::Design;
use std::cmp::Ordering;

/// The cell of `range_mm` that says: the finger was tried, and no range could be measured.
pub const NOT_MEASURABLE: &str = "not measurable";

/// One line of a measurement file: one finger on one task.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// Line in the file, from 1.
    pub line: u64,
    /// Name of the task.
    pub task: String,
    /// The finger's infill, and what else its columns set.
    pub design: Design,
    /// Most negative start that inserted, mm.
    pub negative_mm: Option<f64>,
    /// Most positive start that inserted, mm.
    pub positive_mm: Option<f64>,
    /// Width of the window, mm.
    range_mm: Option<f64>,
    /// Failure below and above the window.
    pub failures: [Option<FailureClass>; 2],
    /// Measurements that the values are the mean of.
    pub repeats: u32,
    /// Largest contact force of the insertions, N.
    pub peak_force_n: Option<f64>,
    /// Day of the measurement, `YYYY-MM-DD`.
    pub date: Option<String>,
    /// Anything.
    pub note: String,
}

/// What is known of a tolerable range, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// It is this.
    Range(f64),
    /// It is this or more: only one side was looked for.
    AtLeast(f64),
    /// Nothing.
    Unknown,
}

impl Experiment {
    /// What the line says of the tolerable range.
    ///
    /// A window holds the start from which it is measured, so that one of its ends bounds the
    /// range from below: "inserts at +1.5 mm" is a range of 1.5 mm or more.
    pub fn extent(&self) -> Extent {
        match (self.range_mm, self.negative_mm, self.positive_mm) {
            (Some(range), ..) => Extent::Range(range),
            (None, Some(negative), Some(positive)) => Extent::Range(positive - negative),
            (None, Some(end), None) | (None, None, Some(end)) => Extent::AtLeast(end.abs()),
            (None, None, None) => Extent::Unknown,
        }
    }

    /// The order in which lines are used, whatever their order in the file: by task, then finger.
    pub fn order(&self, other: &Self) -> Ordering {
        let numbers = |line: &Self| {
            let ends = [line.negative_mm, line.positive_mm, line.range_mm, line.peak_force_n];
            ends.map(|number| number.unwrap_or(f64::NEG_INFINITY))
        };
        let totally = |a: &f64, b: &f64| a.total_cmp(b);
        let setting =
            |a: (&String, &f64), b: (&String, &f64)| a.0.cmp(b.0).then(a.1.total_cmp(b.1));
        let designs = || {
            let (mut a, mut b) = (self.design.0.iter(), other.design.0.iter());
            loop {
                match (a.next(), b.next()) {
                    (Some(a), Some(b)) if setting(a, b).is_eq() => {}
                    (Some(a), Some(b)) => return setting(a, b),
                    (a, b) => return a.is_some().cmp(&b.is_some()),
                }
            }
        };
        let numbers = || {
            let pairs = numbers(self).into_iter().zip(numbers(other));
            pairs.map(|(a, b)| totally(&a, &b)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
        };
        let (task, date) = (self.task.cmp(&other.task), self.date.cmp(&other.date));
        let repeats = self.repeats.cmp(&other.repeats);
        task.then_with(designs).then(date).then_with(numbers).then(repeats)
    }

    /// The range, if it was measured whole, mm.
    pub fn range_mm(&self) -> Option<f64> {
        match self.extent() {
            Extent::Range(range) => Some(range),
            Extent::AtLeast(_) | Extent::Unknown => None,
        }
    }
}

/// Reads and checks a measurement file; `file` is named in errors. An empty file has no lines.
///
/// # Errors
/// All that is wrong with it, with line and column.
pub fn parse(text: &str, file: &str) -> Result<Vec<Experiment>, Problems> {
    // The reader counts a line of a "\r\n" file too few; spreadsheets begin with a mark.
    let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
    if text.trim().is_empty() {
        return Ok(Vec::new());
    }
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let syntax = |error: csv::Error| Problems::syntax(file, &error);
    let columns = column::columns(reader.headers().map_err(syntax)?)
        .map_err(|problem| Problems::one(file, problem))?;
    let (mut found, mut problems) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(syntax)?;
        let at = record.position().map_or(0, csv::Position::line);
        match line::experiment(&columns, &record, at) {
            Ok(experiment) => {
                problems.extend(line::twice(&experiment, &found));
                found.push(experiment);
            }
            Err(more) => problems.extend(more),
        }
    }
    if problems.is_empty() { Ok(found) } else { Err(Problems::new(file, problems)) }
}

/// Checks that each line's task is one of `known`.
///
/// # Errors
/// The lines whose task is not, with the name most like it.
pub fn check_tasks(experiments: &[Experiment], known: &[&str], file: &str) -> Result<(), Problems> {
    let unknown = experiments.iter().filter(|line| !known.contains(&&*line.task));
    let problems: Vec<Problem> = unknown.map(|line| problem::unknown_task(line, known)).collect();
    if problems.is_empty() { Ok(()) } else { Err(Problems::new(file, problems)) }
}
