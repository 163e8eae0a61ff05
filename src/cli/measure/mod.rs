//! `optimize measure`: what was measured on the bench, into and out of a file.

mod add;
mod check;

use super::Failure;
use super::{measured, setup};
use crate::calibration::experiments::Experiment;
use clap::{Args, Subcommand};
use input::shipped::{self, MEASUREMENTS, Source, TASKS};
use insertion::task::Task;

/// Add measurements from the bench to a file, or check such a file.
///
/// The file is `docs/guide/measuring.md`'s measurements.csv. Only the task, the infill and something that
/// was measured are needed; a range alone is enough.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    #[command(after_help = "Example: optimize measure add bench.csv --task ket8 --density 20 \
                            --direction 0 --range-mm 5.7 --failure-negative 3 --failure-positive 3")]
    Add(Box<add::Arguments>),
    #[command(after_help = "Example: optimize measure check bench.csv")]
    Check(check::Arguments),
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.what {
        What::Add(arguments) => add::run(arguments),
        What::Check(arguments) => check::run(arguments),
    }
}

/// How many lines a file has, in words.
fn lines(found: &[Experiment]) -> String {
    match found.len() {
        1 => "1 line".to_owned(),
        count => format!("{count} lines"),
    }
}

/// The measurements of that name or at that path, checked; their tasks are shipped ones or
/// those in `more`.
pub fn read(name: &str, more: &[&str]) -> Result<Vec<Experiment>, Failure> {
    measured::lines(&find(name)?, more)
}

/// A shipped name, or else a path, whatever it looks like.
pub fn find(name: &str) -> Result<Source, Failure> {
    if std::path::Path::new(name).is_file() {
        let text = std::fs::read_to_string(name);
        let unreadable = |error| Failure::usage(format!("{name}: cannot read it: {error}"));
        return Ok(Source { file: name.to_owned(), text: text.map_err(unreadable)? });
    }
    shipped::resolve("measurement file", MEASUREMENTS, name).map_err(Failure::input)
}

/// The name of a task that is shipped or a file.
fn task_name(name: &str) -> Result<String, Failure> {
    let source = setup::find("task", TASKS, name)?;
    Ok(Task::parse(&source.text, &source.file).map_err(Failure::input)?.name)
}
