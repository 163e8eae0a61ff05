//! Parsing and checks of bench measurements: `bench.csv` (`docs/guide/measuring.md`).
//!
//! A line needs the task, the design and at least one measurement; other columns may be left out. Further design
//! parameters are further columns, named as in a space file.

pub mod line;
#[cfg(test)]
mod tests;

use csv::StringRecord;
use input::shipped::nearest;
use input::{InputError, Place, Placed, check_quotes};
use insertion::{DENSITY_KEY, DIRECTION_KEY, Design, FailureClass};
use line::{Cells, is_of_space};
use serde::Serialize;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Text in `range_mm` for a finger that was tested but inserted from no start.
pub const NOT_MEASURABLE: &str = "not measurable";

/// Columns in the order of a new file; further columns are keys of a space file.
pub const COLUMNS: [&str; 12] = [
    "task",
    DENSITY_KEY,
    DIRECTION_KEY,
    "negative_mm",
    "positive_mm",
    "range_mm",
    "failure_negative",
    "failure_positive",
    "repeats",
    "peak_force_n",
    "date",
    "note",
];

/// Prefix of a comment line with the path of the user's task file, relative to the folder of the
/// measurements: `# task usb-c: usb-c.toml`.
const OWN_TASK: &str = "# task ";

/// Returns the comment line for a user's task.
pub fn own_task(name: &str, path: &str) -> String {
    format!("{OWN_TASK}{name}: {path}\n")
}

/// Returns the user's tasks with the paths of their files; of several comment lines of a task, the last one applies.
pub fn own_tasks(text: &str) -> BTreeMap<&str, &str> {
    // Spreadsheets pad lines with commas.
    let named = comments(text).filter_map(|line| line.strip_prefix(OWN_TASK)?.split_once(": "));
    named.map(|(name, path)| (name, path.trim_end_matches([',', ' ']))).collect()
}

fn comments(text: &str) -> impl Iterator<Item = &str> {
    text.trim_start_matches('\u{feff}').lines().filter(|line| line.starts_with('#'))
}

/// Returns whether a text has only comments and blank lines.
fn is_empty(text: &str) -> bool {
    let text = text.trim_start_matches('\u{feff}');
    text.lines().all(|line| line.trim().is_empty() || line.starts_with('#'))
}

fn reader() -> csv::ReaderBuilder {
    let mut reader = csv::ReaderBuilder::new();
    reader.comment(Some(b'#'));
    reader
}

/// All problems of a file, one line each.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.0.iter().map(InputError::to_string).collect::<Vec<_>>().join("\n"))]
pub struct Problems(pub Vec<InputError>);

impl From<InputError> for Problems {
    fn from(error: InputError) -> Self {
        Problems(vec![error])
    }
}

impl Placed for Problems {
    fn place(&self) -> Place {
        self.0.first().map(InputError::place).unwrap_or_default()
    }
}

/// Line of a measurement file: a finger on a task; the fields are the keys of `--json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Experiment {
    pub line: u64,
    pub task: String,
    /// Most negative shift of the start from which it inserted, mm.
    pub negative_mm: Option<f64>,
    /// Most positive shift of the start from which it inserted, mm.
    pub positive_mm: Option<f64>,
    /// Width of the tolerance window, as given or between both ends, mm.
    pub range_mm: Option<f64>,
    /// Failure below the window.
    pub failure_negative: Option<FailureClass>,
    /// Failure above the window.
    pub failure_positive: Option<FailureClass>,
    /// Number of measurements averaged into the values.
    pub repeats: u32,
    pub peak_force_n: Option<f64>,
    /// Day of the measurement, `YYYY-MM-DD`.
    pub date: Option<String>,
    pub note: String,
    /// Infill of the finger, and the other parameters that have a column.
    #[serde(flatten)]
    pub design: Design,
}

impl Experiment {
    /// Returns the range, mm, and whether it is only a lower bound.
    ///
    /// The window contains 0, the task's start, so that one end alone gives a lower bound: "inserts at +1.5 mm" means a
    /// range of at least 1.5 mm.
    pub fn extent(&self) -> Option<(f64, bool)> {
        match (self.range_mm, self.negative_mm, self.positive_mm) {
            (Some(range), ..) => Some((range, false)),
            (None, Some(end), None) | (None, None, Some(end)) => Some((end.abs(), true)),
            _ => None,
        }
    }

    /// Compares lines by task, finger and date, so that results do not depend on their order in the file.
    pub fn order(&self, other: &Self) -> Ordering {
        // The parser rejects lines that agree in all of these, and numbers that are not finite.
        let own = (&self.task, &self.design.0, &self.date);
        let order = own.partial_cmp(&(&other.task, &other.design.0, &other.date));
        order.unwrap_or(Ordering::Equal)
    }
}

/// Columns of a measurement file.
const MEASUREMENT_COLUMNS: Columns<'_> =
    Columns { all: &COLUMNS, required: 3, why: "a line needs the finger and the task" };

/// Reads and checks a measurement file; `file` is named in errors. An empty file has no lines.
pub fn parse(text: &str, file: &str) -> Result<Vec<Experiment>, Problems> {
    rows(text, file, &MEASUREMENT_COLUMNS, line::experiment)
}

/// Reads and checks a measurement file as [`parse`] does, and checks that each task is one of `known`.
///
/// # Errors
/// With all problems of all lines.
pub fn parse_known(text: &str, file: &str, known: &[&str]) -> Result<Vec<Experiment>, Problems> {
    let parse_line = |cells: &mut Cells<'_>, before: &[Experiment]| {
        let found = line::experiment(cells, before);
        if !found.task.is_empty() && !known.contains(&&*found.task) {
            let text = format!(
                "unknown task `{}`{}; available: {}, or your own with --task FILE.toml",
                found.task,
                hint(&found.task, known),
                known.join(", ")
            );
            cells.problem("task", &text);
        }
        found
    };
    rows(text, file, &MEASUREMENT_COLUMNS, parse_line)
}

/// Columns of a table with one finger per line.
pub(crate) struct Columns<'a> {
    /// All columns except keys of a space file, required ones first.
    pub all: &'a [&'a str],
    /// Number of required columns.
    pub required: usize,
    /// Reason why columns are required, for errors.
    pub why: &'a str,
}

/// Reads and checks a table. `parse_line` also receives the preceding lines; it records problems in the cells.
pub(crate) fn rows<T>(
    text: &str,
    file: &str,
    columns: &Columns<'_>,
    mut parse_line: impl FnMut(&mut Cells<'_>, &[T]) -> T,
) -> Result<Vec<T>, Problems> {
    // The CSV reader miscounts the lines of "\r\n" files; spreadsheets write a byte order mark.
    let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n");
    if is_empty(&text) {
        return Ok(Vec::new());
    }
    let at = |place: Option<&csv::Position>| Place::file(file).line(line_at(&text, place) as usize);
    check_quotes(&text, file)?;
    let mut reader = reader().trim(csv::Trim::All).from_reader(text.as_bytes());
    let wrong = |error: csv::Error| at(error.position()).fault(syntax(&error));
    let header = reader.headers().map_err(wrong)?.clone();
    check_header(&header, columns, at(header.position()))?;
    let (mut found, mut problems) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(wrong)?;
        let (header, record, line) = (&header, &record, line_at(&text, record.position()));
        let mut cells = Cells { header, record, file, line, problems: Vec::new() };
        let row = parse_line(&mut cells, &found);
        if cells.problems.is_empty() {
            found.push(row);
        }
        problems.extend(cells.problems);
    }
    if problems.is_empty() { Ok(found) } else { Err(Problems(problems)) }
}

/// Returns the line of a record, for which the CSV reader gives the first line of the comments before it.
fn line_at(text: &str, position: Option<&csv::Position>) -> u64 {
    let Some(position) = position else { return 1 };
    let rest = text.get(position.byte() as usize..).unwrap_or("");
    let bare = |line: &&str| line.is_empty() || line.starts_with('#');
    position.line() + rest.lines().take_while(bare).count() as u64
}

fn syntax(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("has {len} cells where the header has {expected_len}")
        }
        _ => error.to_string(),
    }
}

/// Checks that all columns are known and unique and that no required one is missing.
fn check_header(header: &StringRecord, columns: &Columns<'_>, at: Place) -> Result<(), InputError> {
    let Columns { all, required, why } = columns;
    for (i, name) in header.iter().enumerate() {
        if !is_of_space(name) && !all.contains(&name) {
            let words = format!(
                "is not a known column{}; available: {}, and keys of a space file (task. or finger.)",
                hint(name, all),
                all.join(", ")
            );
            return Err(at.key(name).fault(words));
        }
        if header.iter().take(i).any(|other| other == name) {
            return Err(at.key(name).fault("is given twice; each column may occur once"));
        }
    }
    match all[..*required].iter().find(|required| header.iter().all(|name| name != **required)) {
        None => Ok(()),
        Some(missing) => Err(at.key(missing).fault(format!("is missing; {why}"))),
    }
}

fn hint(name: &str, known: &[&str]) -> String {
    nearest(name, known).map_or(String::new(), |near| format!(" (did you mean `{near}`?)"))
}

/// Appends a line to the text of a file, after a comment line unless `comment` is empty. `cells` are columns with their
/// values; columns that the file lacks are added at the end of each line. A new file has all of [`COLUMNS`].
pub fn appended(text: &str, comment: &str, cells: &[(&str, String)]) -> Result<String, csv::Error> {
    let mut reader = reader().from_reader(text.as_bytes());
    let mut header: Vec<String> = match is_empty(text) {
        true => COLUMNS.map(str::to_owned).to_vec(),
        false => reader.headers()?.iter().map(|name| name.trim().to_owned()).collect(),
    };
    let had = header.len();
    for (column, _) in cells {
        if !header.iter().any(|name| name == column) {
            header.push((*column).to_owned());
        }
    }
    let new = header.iter().map(|name| {
        let cell = cells.iter().find(|(column, _)| column == name);
        cell.map_or("", |(_, text)| text.as_str())
    });
    // Existing lines are kept verbatim unless a column is added.
    let stays = had == header.len() && !is_empty(text);
    let start = match stays {
        true if text.ends_with('\n') => format!("{text}{comment}"),
        true => format!("{text}\n{comment}"),
        false => comments(text).flat_map(|line| [line, "\n"]).chain([comment]).collect(),
    };
    // A cell that begins with `#` is quoted.
    let mut writer = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(start.into_bytes());
    if !stays {
        writer.write_record(&header)?;
        for record in reader.records() {
            let more = std::iter::repeat_n("", header.len() - had);
            writer.write_record(record?.iter().chain(more))?;
        }
    }
    writer.write_record(new)?;
    let bytes = writer.into_inner().map_err(|error| error.into_error())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
