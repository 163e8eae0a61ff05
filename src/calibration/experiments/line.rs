//! One line of a measurement file: its cells, and what they must say together.

use super::{Experiment, NOT_MEASURABLE, cell, problem};
use csv::StringRecord;
use insertion::space::{DENSITY_KEY, DIRECTION_KEY, Design};

/// A range and the window beside it may differ by this, mm: both are rounded to 0.1.
const ROUNDING_MM: f64 = 0.151;

/// The cells of one line, and what was wrong with those read so far.
struct Cells<'a> {
    header: &'a StringRecord,
    record: &'a StringRecord,
    line: u64,
    problems: Vec<String>,
}

impl<'a> Cells<'a> {
    /// The text of a column; empty if the file does not have it.
    fn text(&self, column: &str) -> &'a str {
        let at = self.header.iter().position(|other| other == column);
        at.and_then(|at| self.record.get(at)).unwrap_or("")
    }

    /// The value of a column; what is wrong with it is kept.
    fn read<T>(&mut self, column: &str, value: fn(&str) -> Result<T, String>) -> Option<T> {
        value(self.text(column)).map_err(|words| self.problem(column, &words)).ok()
    }

    /// The same, of a column that may be empty.
    fn known<T>(&mut self, column: &str, value: fn(&str) -> Result<T, String>) -> Option<T> {
        if self.text(column).is_empty() { None } else { self.read(column, value) }
    }

    fn problem(&mut self, column: &str, words: &str) {
        self.problems.push(problem(self.line, column, words));
    }
}

pub(super) fn experiment(
    header: &StringRecord,
    record: &StringRecord,
    line: u64,
) -> Result<Experiment, Vec<String>> {
    let mut cells = Cells { header, record, line, problems: Vec::new() };
    let task = cells.text("task").to_owned();
    if task.is_empty() {
        cells.problem("task", "is empty; name the task");
    }
    let density = cells.read(DENSITY_KEY, cell::density).unwrap_or_default();
    let direction = cells.read(DIRECTION_KEY, cell::direction).unwrap_or_default();
    let mut design = Design::infill(density, direction);
    for key in header.iter().filter(|name| name.starts_with("task.") || name.starts_with("finger."))
    {
        design.0.extend(cells.known(key, cell::number).map(|value| (key.to_owned(), value)));
    }
    let experiment = Experiment {
        line,
        task,
        design,
        negative_mm: cells.known("negative_mm", cell::length),
        positive_mm: cells.known("positive_mm", cell::length),
        range_mm: cells.known("range_mm", cell::range).flatten(),
        failures: ["failure_negative", "failure_positive"]
            .map(|end| cells.known(end, cell::failure)),
        repeats: cells.known("repeats", cell::repeats).unwrap_or(1),
        peak_force_n: cells.known("peak_force_n", cell::force),
        date: cells.known("date", cell::date),
        note: cells.text("note").to_owned(),
    };
    if cells.problems.is_empty() {
        check_window(&mut cells, &experiment);
    }
    if cells.problems.is_empty() { Ok(experiment) } else { Err(cells.problems) }
}

/// A window holds the start from which it is measured, and is as wide as the range.
fn check_window(cells: &mut Cells<'_>, experiment: &Experiment) {
    let &Experiment { negative_mm, positive_mm, range_mm, failures, .. } = experiment;
    for (column, end, right) in [
        ("negative_mm", negative_mm.filter(|end| *end > 0.0), "below"),
        ("positive_mm", positive_mm.filter(|end| *end < 0.0), "above"),
    ] {
        let Some(end) = end else { continue };
        let words =
            format!("is {end}, so that the window excludes 0, the start; it must be 0 or {right}");
        cells.problem(column, &words);
    }
    let known = positive_mm.unwrap_or(0.0) - negative_mm.unwrap_or(0.0);
    let whole = negative_mm.is_some() && positive_mm.is_some();
    if let Some(range) = range_mm
        && (known - range > ROUNDING_MM || (whole && range - known > ROUNDING_MM))
    {
        let words = format!("is {range}, but the window is {known:.2} mm wide; give one of them");
        cells.problem("range_mm", &words);
    }
    let said = cells.text("range_mm") == NOT_MEASURABLE || failures.iter().any(Option::is_some);
    if [negative_mm, positive_mm, range_mm].iter().all(Option::is_none) && !said {
        let words = format!(
            "nothing was measured; give a range, an end of the window or `{NOT_MEASURABLE}`"
        );
        cells.problem("range_mm", &words);
    }
}

/// The same finger on the same task and day as on an earlier line.
pub(super) fn twice(new: &Experiment, before: &[Experiment]) -> Option<String> {
    let same = |old: &&Experiment| {
        old.task == new.task && old.design == new.design && old.date == new.date
    };
    let old = before.iter().find(same)?;
    let words = format!(
        "same finger as in line {}; give the mean with the number of `repeats`, or tell the two \
         apart by `date`",
        old.line
    );
    Some(problem(new.line, "task", &words))
}
