//! One line of a measurement file: its cells, and the checks of their combination.

use super::{Experiment, NOT_MEASURABLE, hint};
use csv::StringRecord;
use input::{InputError, Place, shown, wrong_unit};
use insertion::{DENSITY_KEY, DIRECTION_KEY, Design, FailureClass};
use jiff::civil::Date;
use parameters::numbers;

/// Largest difference between a range and its window, mm: both are rounded to 0.1.
const ROUNDING_MM: f64 = 0.151;

/// Parser of the text of a cell.
type Parser<T> = fn(&str) -> Result<T, String>;

/// Cells of one line, and the problems found so far.
pub(crate) struct Cells<'a> {
    pub(super) header: &'a StringRecord,
    pub(super) record: &'a StringRecord,
    /// Path of the file as given.
    pub(super) file: &'a str,
    pub(crate) line: u64,
    pub(super) problems: Vec<InputError>,
}

impl<'a> Cells<'a> {
    /// Returns the text of a column; empty if the file does not have it.
    pub(crate) fn text(&self, column: &str) -> &'a str {
        let at = self.header.iter().position(|other| other == column);
        at.and_then(|at| self.record.get(at)).unwrap_or("")
    }

    /// Parses the value of a column; records a problem if it is invalid.
    pub(crate) fn read<T>(&mut self, column: &str, value: Parser<T>) -> Option<T> {
        value(self.text(column)).map_err(|words| self.problem(column, &words)).ok()
    }

    /// Parses the value of a column that may be empty.
    pub(crate) fn optional<T>(&mut self, column: &str, value: Parser<T>) -> Option<T> {
        if self.text(column).is_empty() { None } else { self.read(column, value) }
    }

    /// Records a problem; `column` is empty if it concerns the whole line.
    pub(crate) fn problem(&mut self, column: &str, words: &str) {
        let place = Place::file(self.file).line(self.line as usize).key(column);
        self.problems.push(place.fault(words));
    }

    /// Parses the infill and the columns that are keys of a space file.
    pub(crate) fn design(&mut self) -> Design {
        let density = self.read(DENSITY_KEY, density).unwrap_or_default();
        let direction = self.read(DIRECTION_KEY, direction).unwrap_or_default();
        let mut design = Design::infill(density, direction);
        for key in self.header.iter().filter(|name| is_of_space(name)) {
            design.0.extend(self.optional(key, number).map(|value| (key.to_owned(), value)));
        }
        design
    }
}

/// Returns whether a column is a key of a space file.
pub(super) fn is_of_space(name: &str) -> bool {
    name.starts_with("task.") || name.starts_with("finger.")
}

/// Parses and checks a line; problems are recorded in `cells`. `before` are the preceding lines.
pub(super) fn experiment(cells: &mut Cells<'_>, before: &[Experiment]) -> Experiment {
    let task = cells.text("task").to_owned();
    if task.is_empty() {
        cells.problem("task", "is empty; name the task");
    }
    let mut experiment = Experiment {
        line: cells.line,
        task,
        design: cells.design(),
        negative_mm: cells.optional("negative_mm", length),
        positive_mm: cells.optional("positive_mm", length),
        range_mm: cells.optional("range_mm", range).flatten(),
        failure_negative: cells.optional("failure_negative", failure),
        failure_positive: cells.optional("failure_positive", failure),
        repeats: cells.optional("repeats", repeats).unwrap_or(1),
        peak_force_n: cells.optional("peak_force_n", force),
        date: cells.optional("date", date),
        note: cells.text("note").to_owned(),
    };
    if cells.problems.is_empty() {
        check_window(cells, &experiment);
    }
    if cells.problems.is_empty()
        && let Some(words) = duplicate(&experiment, before)
    {
        cells.problem("task", &words);
    }
    let ends = experiment.positive_mm.zip(experiment.negative_mm);
    // Removes the rounding error of the subtraction.
    let width = |(positive, negative): (f64, f64)| ((positive - negative) * 1e6).round() / 1e6;
    experiment.range_mm = experiment.range_mm.or(ends.map(width));
    experiment
}

/// Checks that the window contains 0, the task's start, and is as wide as the range.
fn check_window(cells: &mut Cells<'_>, experiment: &Experiment) {
    let &Experiment { negative_mm, positive_mm, range_mm, .. } = experiment;
    for (column, end, right) in [
        ("negative_mm", negative_mm.filter(|end| *end > 0.0), "below"),
        ("positive_mm", positive_mm.filter(|end| *end < 0.0), "above"),
    ] {
        let Some(end) = end else { continue };
        let words =
            format!("is {end}, so that the window excludes 0, the start; it must be 0 or {right}");
        cells.problem(column, &words);
    }
    let width = positive_mm.unwrap_or(0.0) - negative_mm.unwrap_or(0.0);
    let whole = negative_mm.is_some() && positive_mm.is_some();
    if let Some(range) = range_mm
        && (width - range > ROUNDING_MM || (whole && range - width > ROUNDING_MM))
    {
        let words = format!("is {range}, but the window is {width:.2} mm wide; give one of them");
        cells.problem("range_mm", &words);
    }
    let not_measurable = cells.text("range_mm") == NOT_MEASURABLE;
    if not_measurable && whole {
        let words =
            format!("is `{NOT_MEASURABLE}`, but both ends are given; leave one or the other out");
        cells.problem("range_mm", &words);
    }
    let failure = experiment.failure_negative.or(experiment.failure_positive);
    let has_other = not_measurable || failure.is_some();
    if [negative_mm, positive_mm, range_mm].iter().all(Option::is_none) && !has_other {
        let words = format!(
            "nothing was measured; give a range, an end of the window or `{NOT_MEASURABLE}`"
        );
        cells.problem("range_mm", &words);
    }
}

/// Returns the error message if an earlier line has the same finger, task and day.
fn duplicate(new: &Experiment, before: &[Experiment]) -> Option<String> {
    let same = |old: &&Experiment| {
        old.task == new.task && old.design == new.design && old.date == new.date
    };
    let old = before.iter().find(same)?;
    Some(format!(
        "same finger as in line {}; give the mean with the number of `repeats`, or distinguish the two \
         by `date`",
        old.line
    ))
}

/// Largest length, mm; a larger one is taken for micrometres.
pub const LARGEST_LENGTH_MM: f64 = 100.0;
/// Smallest length other than 0, mm, below the resolution of the starts; a smaller one is taken for metres.
const MIN_LENGTH_MM: f64 = 0.02;
/// Largest force, N; a larger one is taken for millinewtons.
pub const LARGEST_FORCE_N: f64 = 5000.0;

fn number(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a number")),
    }
}

/// Parses an infill density, percent.
fn density(text: &str) -> Result<f64, String> {
    let percent = number(text)?;
    numbers::problem(DENSITY_KEY, percent).map_or(Ok(percent), Err)
}

/// Parses an infill direction, degrees.
fn direction(text: &str) -> Result<f64, String> {
    let degrees = number(text)?;
    let radians = wrong_unit::direction(degrees)
        .map(|radians| radians.join(" ") + ", or round to 0.1 degrees");
    radians.or_else(|| numbers::problem(DIRECTION_KEY, degrees)).map_or(Ok(degrees), Err)
}

/// Parses a length, mm.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    let looks_like = |value: f64, unit: &str, mm: f64| {
        Err(format!("{value} looks like {unit}; give millimetres, as in {}", shown(mm)))
    };
    match number(text)? {
        long if long.abs() > LARGEST_LENGTH_MM => looks_like(long, "micrometres", long / 1e3),
        short if short != 0.0 && short.abs() < MIN_LENGTH_MM => {
            looks_like(short, "metres", short * 1e3)
        }
        length => Ok(length),
    }
}

/// Parses a range, mm; `None` if it is not measurable.
fn range(text: &str) -> Result<Option<f64>, String> {
    if text == NOT_MEASURABLE {
        return Ok(None);
    }
    match length(text)? {
        below if below < 0.0 => Err(format!("is {below}; a range is 0 or above")),
        range => Ok(Some(range)),
    }
}

/// Parses the number or the name of a failure class.
pub(crate) fn failure(text: &str) -> Result<FailureClass, String> {
    let all = FailureClass::ALL;
    let is = |class: &FailureClass| {
        text == class.number().to_string() || [class.label(), class.short()].contains(&text)
    };
    all.into_iter().find(is).ok_or_else(|| {
        let known = all.map(|class| format!("{} ({})", class.number(), class.label())).join(", ");
        let near = hint(text, &all.map(FailureClass::label));
        format!("unknown failure class `{text}`{near}; available: {known}")
    })
}

/// Parses the number of measurements averaged into the values.
fn repeats(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(count @ 1..=10_000) => Ok(count),
        _ => Err(format!("`{text}` is not a whole number from 1 to 10000")),
    }
}

/// Parses a peak force, N.
fn force(text: &str) -> Result<f64, String> {
    match number(text)? {
        large if large > LARGEST_FORCE_N => Err(format!(
            "{large} looks like millinewtons; give newtons, as in {}",
            shown(large / 1e3)
        )),
        below if below < 0.0 => Err(format!("is {below}; a largest force is 0 or above")),
        force => Ok(force),
    }
}

fn date(text: &str) -> Result<String, String> {
    let day = text.parse::<Date>();
    day.map(|day| day.to_string())
        .map_err(|_| format!("`{text}` is not a date; give one like 2026-03-31"))
}
