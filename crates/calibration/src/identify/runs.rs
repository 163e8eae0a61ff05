//! `runs.csv`: a line for each log, with the finger, the offset and how it ended.

use super::frame::Frame;
use super::log::{Ended, Log, Run};
use super::read;
use crate::experiments::line::{Cells, failure, length};
use crate::experiments::{Columns, Problems, problem, rows};
use input::files::{self, LARGEST_INPUT};
use input::units::MM;
use input::{Fault, Place};
use insertion::space::{DENSITY_KEY, DIRECTION_KEY, Design};
use std::path::Path;

/// Columns of the table; further ones are keys of a space file.
pub const COLUMNS: [&str; 7] =
    ["log", DENSITY_KEY, DIRECTION_KEY, "offset_mm", "outcome", "date", "note"];
/// Most moments of all logs together, 0.2 GB.
const MOST: usize = 2_000_000;

/// A line of the table.
struct Row {
    log: String,
    design: Design,
    offset_mm: f64,
    ended: Ended,
    line: u64,
}

fn row(cells: &mut Cells<'_>, before: &[Row]) -> Row {
    let log = cells.text("log").to_owned();
    match before.iter().find(|old| old.log == log) {
        _ if log.is_empty() => cells.problem("log", "is empty; name the file of the log"),
        Some(old) => {
            let words = format!("same log as in line {}; each log stands once", old.line);
            cells.problem("log", &words);
        }
        None => {}
    }
    let ended = cells.read("outcome", ended).unwrap_or(Ended::Probe);
    let offset_mm = match ended {
        Ended::Probe => cells.known("offset_mm", length),
        _ => cells.read("offset_mm", length),
    };
    let (design, line) = (cells.design(), cells.line);
    Row { log, design, offset_mm: offset_mm.unwrap_or(0.0), ended, line }
}

fn ended(text: &str) -> Result<Ended, String> {
    match text {
        "inserted" => Ok(Ended::Inserted),
        "probe" => Ok(Ended::Probe),
        class => failure(class)
            .map(Ended::Failed)
            .map_err(|words| format!("{words}, and `inserted` and `probe`")),
    }
}

/// Reads a table of runs and its logs, whose paths are from its folder; logs in the robot's base
/// need `frame`; `text_of` reads the text of a log.
///
/// # Errors
/// If the table cannot be read or used, has no attempt, or a log cannot be used.
pub fn read(
    path: &Path,
    frame: Option<&Frame>,
    text_of: impl Fn(&Path) -> Result<String, Fault>,
) -> Result<Vec<Run>, Problems> {
    let file = path.display().to_string();
    let text = files::read_text(path, LARGEST_INPUT)
        .map_err(|error| Place::file(&file).fault(format!("cannot be read: {error}")))?;
    let why = "a line says of a log which finger it is of, where it started and how it ended";
    let table = rows(&text, &file, &Columns { all: &COLUMNS, required: 5, why }, row)?;
    if table.iter().all(|row| row.ended == Ended::Probe) {
        let words = "has no attempt; give one line at least whose outcome is `inserted` or a class";
        return Err(Place::file(file).fault(words).into());
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let (mut runs, mut moments) = (Vec::new(), 0);
    for Row { log, design, offset_mm, ended, line } in table {
        let log = folder.join(log);
        let log: Log = read::parse(&text_of(&log)?, &log.display().to_string(), frame)?;
        moments += log.moments.len();
        if moments > MOST {
            let words =
                format!("the logs to here have over {MOST} moments; cut them to the attempts");
            return Err(Problems::of(&file, vec![problem(line, "log", &words)]));
        }
        runs.push(Run { log, design, offset: offset_mm * MM, ended, line: line as usize });
    }
    Ok(runs)
}
