//! One line of a measurement file: its cells, and what they must say together.

use super::problem::Problem;
use super::{Column, Experiment, NOT_MEASURABLE, cell};
use csv::StringRecord;
use insertion::space::Design;

/// A range and the window beside it may differ by this, mm: both are rounded to 0.1.
const ROUNDING_MM: f64 = 0.151;

/// The cells of one line, and what was wrong with those read so far.
struct Cells<'a> {
    columns: &'a [Column],
    record: &'a StringRecord,
    line: u64,
    problems: Vec<Problem>,
}

impl Cells<'_> {
    /// The text of a column; empty if the file does not have it.
    fn text(&self, column: &Column) -> &str {
        let at = self.columns.iter().position(|other| other == column);
        at.and_then(|at| self.record.get(at)).unwrap_or("")
    }

    /// The value of a column; what is wrong with it is kept.
    fn read<T>(&mut self, column: Column, value: fn(&str) -> Result<T, String>) -> Option<T> {
        let read = value(self.text(&column));
        read.map_err(|words| self.problem(&column, words)).ok()
    }

    fn problem(&mut self, column: &Column, words: String) {
        self.problems.push(Problem::new(self.line, column.name(), words));
    }
}

/// Reads a line.
pub(super) fn experiment(
    columns: &[Column],
    record: &StringRecord,
    line: u64,
) -> Result<Experiment, Vec<Problem>> {
    let mut cells = Cells { columns, record, line, problems: Vec::new() };
    let task = cells.read(Column::Task, |text| match text {
        "" => Err("is empty; name the task".to_owned()),
        name => Ok(name.to_owned()),
    });
    let infill = [
        cells.read(Column::Density, cell::density),
        cells.read(Column::Direction, cell::direction),
    ];
    let set: Vec<(String, Option<f64>)> = columns
        .iter()
        .filter_map(|column| match column {
            Column::Set(key) => Some((key.clone(), cells.read(column.clone(), cell::set)?)),
            _ => None,
        })
        .collect();
    let negative_mm = cells.read(Column::Negative, cell::length).flatten();
    let positive_mm = cells.read(Column::Positive, cell::length).flatten();
    let range_mm = cells.read(Column::Range, cell::range).flatten();
    let below = cells.read(Column::FailureNegative, cell::failure).flatten();
    let above = cells.read(Column::FailurePositive, cell::failure).flatten();
    let repeats = cells.read(Column::Repeats, cell::repeats);
    let peak_force_n = cells.read(Column::PeakForce, cell::force).flatten();
    let date = cells.read(Column::Date, cell::date).flatten();
    let note = cells.text(&Column::Note).to_owned();
    if cells.problems.is_empty() {
        check_window(&mut cells, negative_mm, positive_mm, range_mm);
        let said =
            cells.text(&Column::Range) == NOT_MEASURABLE || below.is_some() || above.is_some();
        if [negative_mm, positive_mm, range_mm].iter().all(Option::is_none) && !said {
            let words = format!(
                "nothing was measured; give a range, an end of the window or `{NOT_MEASURABLE}`"
            );
            cells.problem(&Column::Range, words);
        }
    }
    let (Some(task), [Some(density), Some(direction)], Some(repeats), true) =
        (task, infill, repeats, cells.problems.is_empty())
    else {
        return Err(cells.problems);
    };
    let mut design = Design::infill(density, direction);
    design.0.extend(set.into_iter().filter_map(|(key, value)| Some((key, value?))));
    let failures = [below, above];
    Ok(Experiment {
        line,
        task,
        design,
        negative_mm,
        positive_mm,
        range_mm,
        failures,
        repeats,
        peak_force_n,
        date,
        note,
    })
}

/// A window holds the start from which it is measured, and is as wide as the range.
fn check_window(
    cells: &mut Cells<'_>,
    negative: Option<f64>,
    positive: Option<f64>,
    range: Option<f64>,
) {
    if let Some(negative) = negative.filter(|end| *end > 0.0) {
        let words = format!(
            "is {negative}, so that the window excludes 0, the start; it must be 0 or below"
        );
        cells.problem(&Column::Negative, words);
    }
    if let Some(positive) = positive.filter(|end| *end < 0.0) {
        let words = format!(
            "is {positive}, so that the window excludes 0, the start; it must be 0 or above"
        );
        cells.problem(&Column::Positive, words);
    }
    let known = positive.unwrap_or(0.0) - negative.unwrap_or(0.0);
    let whole = negative.is_some() && positive.is_some();
    if let Some(range) = range
        && (known - range > ROUNDING_MM || (whole && range - known > ROUNDING_MM))
    {
        let words = format!("is {range}, but the window is {known:.2} mm wide; give one of them");
        cells.problem(&Column::Range, words);
    }
}

/// The same finger on the same task and day as on an earlier line.
pub(super) fn twice(new: &Experiment, before: &[Experiment]) -> Option<Problem> {
    let same = |old: &&Experiment| {
        old.task == new.task && old.design == new.design && old.date == new.date
    };
    let old = before.iter().find(same)?;
    let words = format!(
        "same finger as in line {}; give the mean with the number of `repeats`, or tell the two \
         apart by `date`",
        old.line
    );
    Some(Problem::new(new.line, Column::Task.name(), words))
}
