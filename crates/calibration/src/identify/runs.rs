//! `runs.csv`: a line for each log, with the finger, the offset and the outcome.

use super::frame::Frame;
use super::log::{Log, Run};
use super::read;
use crate::experiments::line::{Cells, failure, length};
use crate::experiments::{Columns, Problems, rows};
use input::files::{self, LARGEST_INPUT};
use input::units::MM;
use input::{InputError, Place};
use insertion::{DENSITY_KEY, DIRECTION_KEY, Outcome};
use std::path::Path;

/// Columns of the table; further ones are keys of a space file.
pub const COLUMNS: [&str; 7] =
    ["log", DENSITY_KEY, DIRECTION_KEY, "offset_mm", "outcome", "date", "note"];

/// Parses a line; problems are recorded in `cells`.
fn run_line(cells: &mut Cells<'_>, before: &[Run<String>]) -> Run<String> {
    let log = cells.text("log").to_owned();
    match before.iter().find(|old| old.log == log) {
        _ if log.is_empty() => cells.problem("log", "is empty; name the file of the log"),
        Some(old) => {
            cells.problem("log", &format!("same log as in line {}; list each log once", old.line));
        }
        None => {}
    }
    let outcome = cells.read("outcome", outcome).flatten();
    let offset_mm = match outcome {
        None => cells.optional("offset_mm", length),
        Some(_) => cells.read("offset_mm", length),
    };
    let (design, line) = (cells.design(), cells.line as usize);
    Run { log, design, offset: offset_mm.unwrap_or(0.0) * MM, outcome, line }
}

/// Parses the outcome of an attempt; `None` for a probe.
fn outcome(text: &str) -> Result<Option<Outcome>, String> {
    match text {
        "inserted" => Ok(Some(Outcome::Inserted)),
        "probe" => Ok(None),
        class => failure(class)
            .map(|class| Some(Outcome::Failed(class)))
            .map_err(|words| format!("{words}, `inserted`, `probe`")),
    }
}

/// Reads a table of runs and its logs, whose paths are relative to its folder. Logs in the robot's base need `frame`;
/// `text_of` reads the text of a log.
///
/// # Errors
/// If the table cannot be read, is invalid or has no attempt, or if a log cannot be read or is invalid.
pub fn read(
    path: &Path,
    frame: Option<&Frame>,
    mut text_of: impl FnMut(&Path) -> Result<String, InputError>,
) -> Result<Vec<Run>, Problems> {
    let file = path.display().to_string();
    let text = files::read_text(path, LARGEST_INPUT)
        .map_err(|error| Place::file(&file).fault(format!("cannot be read: {error}")))?;
    let why = "each line needs a log, the infill of its finger, its offset and its outcome";
    let table = rows(&text, &file, &Columns { all: &COLUMNS, required: 5, why }, run_line)?;
    if table.iter().all(|row| row.outcome.is_none()) {
        let words =
            "has no attempt; give at least one line with outcome `inserted` or a failure class";
        return Err(Place::file(file).fault(words).into());
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let run = |Run { log, design, offset, outcome, line }: Run<String>| {
        let log = folder.join(log);
        let log: Log = read::parse(&text_of(&log)?, &log.display().to_string(), frame)?;
        Ok(Run { log, design, offset, outcome, line })
    };
    table.into_iter().map(run).collect()
}
