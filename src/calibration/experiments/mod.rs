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
