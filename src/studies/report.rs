//! The tables, plots and page of a study.

use super::around::Around;
use super::unusable;
use crate::failure::Failure;
use crate::setup::surrogate_of;
use input::files::{self, LARGEST_OWN};
use insertion::surrogate::Model;
use report::replay::{ENDS, pair_file};
use report::{self, Beside, printer};
use std::path::Path;
use study::{StudyRecord, write_evaluations_csv, write_own_file};

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
pub(crate) fn write(dir: &Path, record: &StudyRecord, model: &Model) -> Result<(), Failure> {
    write_evaluations_csv(dir, record)?;
    write_own_file(&dir.join("convergence.svg"), &report::convergence_svg(record, FILE)?)?;
    if let Some(front) = report::front_svg(record, FILE)? {
        write_own_file(&dir.join("front.svg"), &front)?;
    }
    write_own_file(&dir.join(PAGE), &report::page(record, model, &beside(dir, record)?)?)?;
    Ok(())
}

/// Reads the analyses that the study kept beside its page.
fn beside(dir: &Path, record: &StudyRecord) -> Result<Beside, Failure> {
    let read = |name: &str| files::read_own(&dir.join(name), LARGEST_OWN).ok();
    let names = printer::FILES.iter().map(|(name, _)| *name);
    let mut beside = Beside {
        dir: dir.to_owned(),
        files: names.filter(|name| dir.join(name).exists()).collect(),
        nominal: read(unusable::PICTURE),
        ..Beside::default()
    };
    let around = Around::read(dir, record);
    beside.robots = around.robots;
    if let Some(found) = &around.levers {
        beside.levers = Some((found.sentence(), report::levers::svg(found)?));
    }
    for map in &around.maps {
        beside.maps.push((map.caption(), report::map::svg(map)?));
    }
    // First what is shown first: a page has no room for the films of many tasks.
    let shown = report::preferred(record);
    let (first, others): (Vec<_>, Vec<_>) =
        ENDS.into_iter().map(|(end, _)| end).partition(|end| *end == shown);
    for (task, end) in (0..record.config.tasks.len())
        .flat_map(|task| first.iter().chain(&others).map(move |&end| (task, end)))
    {
        if let Some(page) = read(&pair_file(task, end)) {
            beside.add(task, end, &page);
        }
    }
    Ok(beside)
}
