//! `optimize measure add`: adds a line to a measurement file.

use crate::setup::measured::BenchFileRequest;
use crate::terminal::say;
use crate::{Context, Failure, Output, TaskFile, command, read_task};
use calibration::experiments::{
    COLUMNS, Experiment, NOT_MEASURABLE, Problems, appended, own_task, own_tasks, parse,
};
use clap::builder::UnknownArgumentValueParser;
use input::InputError;
use input::files::{LARGEST_INPUT, LockedFile};
use input::shipped::{COMMERCIAL, MEASUREMENTS, TASKS};
use insertion::{DENSITY_KEY, DIRECTION_KEY};
use report::answer::words;
use serde::Serialize;
use std::io::{self, BufRead};
use std::path::Path;

/// Add a line to a measurement file, which is created if needed; without options it prompts for each value
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: optimize measure add bench.csv --task ket8 --density 20 --direction 0 \
                  --range-mm 5.7 --failure-negative 3 --failure-positive 3"
)]
pub struct Request {
    /// The file.
    #[command(flatten)]
    pub file: BenchFileRequest,
    /// Task: ket8, ket12, rj45, usb, rj45_latch, usb_a, the path of a task file, or a name in the measurement file
    #[arg(long, value_name = "NAME")]
    pub task: Option<String>,
    /// Infill density, percent
    #[arg(long, value_name = "PERCENT")]
    pub density: Option<String>,
    /// Infill direction, degrees
    #[arg(long, value_name = "DEG")]
    pub direction: Option<String>,
    /// Most negative start that inserted, mm
    #[arg(long, value_name = "MM")]
    pub negative_mm: Option<String>,
    /// Most positive start that inserted, mm
    #[arg(long, value_name = "MM")]
    pub positive_mm: Option<String>,
    /// Width of the window, mm
    #[arg(long, value_name = "MM", conflicts_with = "not_measurable")]
    pub range_mm: Option<String>,
    /// The finger was tested, but no range could be measured
    #[arg(long)]
    pub not_measurable: bool,
    /// Failure class below the window: 1 to 4, or its name
    #[arg(long, value_name = "CLASS")]
    pub failure_negative: Option<String>,
    /// Failure class above the window: 1 to 4, or its name
    #[arg(long, value_name = "CLASS")]
    pub failure_positive: Option<String>,
    /// Number of measurements whose mean is given
    #[arg(long, value_name = "N")]
    pub repeats: Option<String>,
    /// Largest contact force, N
    #[arg(long, value_name = "N")]
    pub peak_force_n: Option<String>,
    /// Day, YYYY-MM-DD
    #[arg(long, value_name = "DAY")]
    pub date: Option<String>,
    /// Any text
    #[arg(long, value_name = "TEXT")]
    pub note: Option<String>,
    /// Another design parameter, for example of spaces/codesign.toml; may be given several times
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, String)>,
    /// Refused with a tip: other commands name the file that they write by this option
    #[arg(long, hide = true, value_name = "FILE", value_parser = UnknownArgumentValueParser::suggest(
        "the measurement file is named without it: optimize measure add FILE"))]
    pub out: Option<String>,
    /// Check the line without writing it
    #[arg(long, hide = true)]
    pub dry_run: bool,
}

fn setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if key.starts_with("task.") || key.starts_with("finger.") => {
            Ok((key.to_owned(), value.to_owned()))
        }
        _ => Err("must be KEY=NUMBER, for example task.strategy.tilt_deg=8".to_owned()),
    }
}

impl command::Request for Request {
    fn run(&self, _context: &Context<'_>) -> Result<Output, Failure> {
        let (file, mut cells) = (self.file.name(), self.cells());
        if MEASUREMENTS.iter().any(|shipped| shipped.name == file) {
            let problem = format!("`{file}` is shipped; give the path of your own file");
            return Err(Failure::usage(problem));
        }
        if cells.is_empty() {
            cells = prompt(&mut io::stdin().lock())?;
        }
        let found = add(file, cells, self.dry_run)?;
        let (lines, added) = (found.len(), found.last());
        let word = if self.dry_run { "valid" } else { "added" };
        let mut text =
            added.map_or(String::new(), |line| format!("{word}         {}\n", shown(line)));
        text += &format!("file          {file}: {}\n", input::counted(lines, "line"));
        Ok(Output::new(text, Added { file, lines, added }))
    }
}

/// Result: the file, its number of lines, and the new one.
#[derive(Serialize)]
struct Added<'a> {
    file: &'a str,
    lines: usize,
    added: Option<&'a Experiment>,
}

/// Returns task, finger, range and ends of a line as text: `usb, 10 % infill at 6°: 9.3 mm (-4.1 to +5.2)`.
fn shown(line: &Experiment) -> String {
    let range = match line.extent() {
        Some((mm, true)) => format!("at least {} mm", input::shown(mm)),
        Some((mm, false)) => format!("{} mm", input::shown(mm)),
        None => NOT_MEASURABLE.to_owned(),
    };
    let ends = [line.negative_mm, line.positive_mm].into_iter().flatten();
    let ends: Vec<String> = ends.map(|mm| format!("{mm:+}")).collect();
    let ends = if ends.is_empty() { String::new() } else { format!(" ({})", ends.join(" to ")) };
    format!("{}, {}: {range}{ends}", line.task, words::design(&line.design))
}

/// Adds a line with these cells, or with `dry_run` only checks it, and returns all lines.
fn add(
    file: &str,
    mut cells: Vec<(&str, String)>,
    dry_run: bool,
) -> Result<Vec<Experiment>, Failure> {
    let mut own = None;
    let unusable = |error| Failure::in_file(file, format!("cannot add a line: {error}"));
    let unwritable = |error| Failure::running(format!("{file}: cannot write: {error}"));
    // Locked while it is read and written, since others add lines, too.
    let table = LockedFile::open(Path::new(file), LARGEST_INPUT).map_err(unusable)?;
    let before = parse(table.text(), file).map_err(Failure::input)?;
    let named = own_tasks(table.text());
    let is_new =
        |name: &str| !named.contains_key(name) && before.iter().all(|line| line.task != name);
    let task = cells.iter_mut().find(|(column, _)| *column == "task");
    if let Some((_, name)) = task.filter(|(_, name)| is_new(name)) {
        let TaskFile { source, task } = read_task(name)?;
        let shipped =
            [TASKS, COMMERCIAL].concat().iter().any(|shipped| shipped.text == source.text);
        // Relative to the folder of the measurements, if it is inside, else absolute.
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        let path = Path::new(name).strip_prefix(folder).map(Path::to_owned);
        let path = path.or_else(|_| std::path::absolute(&*name)).map_err(Failure::input)?;
        own = (!shipped).then(|| (task.name.clone(), path.display().to_string()));
        *name = task.name;
    }
    let new = |(name, path): &(String, String)| named.get(&**name) != Some(&&**path);
    let comment = own.filter(new).map_or(String::new(), |(name, path)| own_task(&name, &path));
    let new = appended(table.text(), &comment, &cells).map_err(Failure::input)?;
    // Any problem is one of the new line.
    let found = parse(&new, file).map_err(|problems| of_options(&problems))?;
    if !dry_run {
        table.replace(&new).map_err(unwritable)?;
    }
    Ok(found)
}

/// Returns the error of a new line, with options in place of the line and its columns.
fn of_options(problems: &Problems) -> Failure {
    let option = |column: &str| match column {
        DENSITY_KEY => "--density".to_owned(),
        DIRECTION_KEY => "--direction".to_owned(),
        key if key.contains('.') => format!("--set {key}"),
        column => format!("--{}", column.replace('_', "-")),
    };
    let text = |one: &InputError| match &one.place.key {
        Some(column) => format!("{}: {}", option(column), one.problem),
        None => one.to_string(),
    };
    Failure::usage(problems.0.iter().map(text).collect::<Vec<_>>().join("\n"))
}

impl Request {
    fn cells(&self) -> Vec<(&str, String)> {
        let range = self.not_measurable.then(|| NOT_MEASURABLE.to_owned());
        let range = range.or_else(|| self.range_mm.clone());
        let given = [
            &self.task,
            &self.density,
            &self.direction,
            &self.negative_mm,
            &self.positive_mm,
            &range,
            &self.failure_negative,
            &self.failure_positive,
            &self.repeats,
            &self.peak_force_n,
            &self.date,
            &self.note,
        ];
        let given = COLUMNS.into_iter().zip(given);
        let given = given.filter_map(|(column, value)| Some((column, value.clone()?)));
        given.chain(self.set.iter().map(|(key, value)| (key.as_str(), value.clone()))).collect()
    }
}

/// Prompts for each column on standard input until it ends; an empty answer leaves the cell empty.
fn prompt(answers: &mut impl BufRead) -> Result<Vec<(&'static str, String)>, Failure> {
    let failed = |error: io::Error| Failure::running(format!("cannot read the answer: {error}"));
    let mut cells = Vec::new();
    say(&format!("leave unknown values empty; range_mm may be `{NOT_MEASURABLE}`"));
    for column in COLUMNS {
        say(column);
        let mut answer = String::new();
        if answers.read_line(&mut answer).map_err(failed)? == 0 {
            break;
        }
        let answer = answer.trim();
        if !answer.is_empty() {
            cells.push((column, answer.to_owned()));
        }
    }
    if cells.is_empty() {
        return Err(Failure::usage("no value was given; see `optimize measure add --help`"));
    }
    Ok(cells)
}
