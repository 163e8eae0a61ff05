//! The tables, plots and page of a study.

use super::Failure;
use super::setup::surrogate_of;
use crate::report::replay::{ENDS, pair_file};
use crate::report::{self, Beside, printer};
use crate::study::{StudyRecord, write_evaluations_csv, write_own_file};
use input::files::{self, LARGEST_OWN};
use insertion::surrogate::Model;
use std::path::Path;

/// Writes tables, plots and page of the study in a folder again; gives what it measured.
pub fn rewrite(dir: &Path) -> Result<StudyRecord, Failure> {
    let record = StudyRecord::load(dir)?;
    let model = surrogate_of(&record.inputs(dir)?)?;
    write(dir, &record, &model)?;
    Ok(record)
}

/// The page among a report's files.
pub const PAGE: &str = "report.html";
/// Pixels of a plot in a file of its own.
const FILE: (u32, u32) = (880, 480);

/// Writes all that is made of a study into its folder: table, plot and page.
pub(super) fn write(dir: &Path, record: &StudyRecord, model: &Model) -> Result<(), Failure> {
    write_evaluations_csv(dir, record)?;
    write_own_file(&dir.join("convergence.svg"), &report::convergence_svg(record, FILE)?)?;
    if let Some(front) = report::front_svg(record, FILE)? {
        write_own_file(&dir.join("front.svg"), &front)?;
    }
    write_own_file(&dir.join(PAGE), &report::page(record, model, &beside(dir, record))?)?;
    Ok(())
}

/// The films and the files for the printer that the study kept.
fn beside(dir: &Path, record: &StudyRecord) -> Beside {
    let several = record.config.several_tasks();
    let of = |(at, task): (usize, &str)| {
        let on = if several { format!(" on {task}") } else { String::new() };
        ENDS.map(|(end, _)| {
            let page = files::read_own(&dir.join(pair_file(at, end)), LARGEST_OWN).ok()?;
            Some((format!("Play the {end} end{on}"), page))
        })
    };
    let replays = record.config.tasks().enumerate().flat_map(of).flatten().collect();
    let printable = [printer::SURFACE, printer::SHEET].iter().all(|name| dir.join(name).exists());
    Beside { replays, printable }
}
