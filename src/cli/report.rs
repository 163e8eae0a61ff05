//! `optimize report DIR`: makes the tables and plots of a study again.

use super::setup;
use super::{Failure, print};
use crate::report::replay::PairEnd;
use crate::report::{self, Beside, Replay, printer};
use crate::study::{StudyRecord, write_evaluations_csv, write_own_file};
use clap::Args;
use input::files::{self, LARGEST_OWN};
use insertion::surrogate::Model;
use std::path::{Path, PathBuf};

/// Report on a study.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder of the study
    dir: PathBuf,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let dir = &arguments.dir;
    let record = StudyRecord::load(dir)?;
    let inputs = record.inputs(dir)?;
    let surrogate = setup::surrogate_of(&inputs)?;
    write(dir, &record, &surrogate)?;
    let count = record.evaluations.len();
    let page = dir.join(PAGE);
    print(&format!("wrote the report of {count} evaluations: {}\n", page.display()))
}

/// The page among a report's files.
pub const PAGE: &str = "report.html";

/// Writes all that is made of a study into its folder: table, plot and page.
pub fn write(dir: &Path, record: &StudyRecord, model: &Model) -> Result<(), Failure> {
    let drawn = |error: report::ReportError| Failure::running(error.to_string());
    write_evaluations_csv(dir, record)?;
    write_own_file(&dir.join("convergence.svg"), &report::convergence_svg(record).map_err(drawn)?)?;
    if let Some(front) = report::front_svg(record).map_err(drawn)? {
        write_own_file(&dir.join("front.svg"), &front)?;
    }
    write_own_file(
        &dir.join(PAGE),
        &report::page(record, model, &beside(dir, record)).map_err(drawn)?,
    )?;
    Ok(())
}

/// The films and the files for the printer that the study kept.
fn beside(dir: &Path, record: &StudyRecord) -> Beside {
    let several = record.config.several_tasks();
    let of = |(at, task): (usize, &str)| {
        let on = if several { format!(" on {task}") } else { String::new() };
        PairEnd::BOTH.map(|end| {
            let page = files::read_own(&dir.join(end.file(at)), LARGEST_OWN).ok()?;
            Some(Replay { label: format!("Play the {} end{on}", end.word()), page })
        })
    };
    let replays = record.config.tasks().enumerate().flat_map(of).flatten().collect();
    let printable = [printer::SURFACE, printer::SHEET].iter().all(|name| dir.join(name).exists());
    Beside { replays, printable }
}
