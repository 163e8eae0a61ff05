//! Tables, plots and report page of a study.

use super::{analysis, unusable};
use crate::Failure;
use input::files::{self, LARGEST_OWN};
use report::answer::Answer;
use report::replay::{ENDS, pair_file, poster_file};
use report::{self, PageFiles, printer};
use std::path::Path;
use study::{EVALUATIONS_CSV, StudyRecord, evaluations_csv, write_own_file};

/// Writes tables, plots and report page of the study in a folder again; returns its record.
///
/// # Errors
/// If the study cannot be read or a file cannot be written.
pub fn rewrite(dir: &Path) -> Result<StudyRecord, Failure> {
    let record = StudyRecord::load(dir)?;
    write(dir, &Answer::of(&record))?;
    Ok(record)
}

/// File of the report page.
pub const PAGE: &str = "report.html";
/// Size of a plot in its own file, pixels.
const FILE: (u32, u32) = (880, 480);

/// Writes table, plots and page of a study into its folder.
pub(crate) fn write(dir: &Path, answer: &Answer) -> Result<(), Failure> {
    let record = answer.record;
    write_own_file(&dir.join(EVALUATIONS_CSV), &evaluations_csv(dir, record)?)?;
    write_own_file(&dir.join("convergence.svg"), &report::convergence_svg(record, FILE)?)?;
    if let Some(front) = report::front_svg(record, FILE)? {
        write_own_file(&dir.join("front.svg"), &front)?;
    }
    write_own_file(&dir.join(PAGE), &report::page(answer, &page_files(dir, answer))?)?;
    Ok(())
}

/// Reads the files that the page shows or links.
fn page_files(dir: &Path, answer: &Answer) -> PageFiles {
    let read = |name: &str| files::read_text(&dir.join(name), LARGEST_OWN).ok();
    let names = printer::FILES.iter().map(|(name, _)| *name);
    let files = names.filter(|name| dir.join(name).exists()).collect();
    let (nominal, analyses) = (read(unusable::PICTURE), analysis::read(dir, answer));
    let mut files = PageFiles { dir: dir.to_owned(), films: Vec::new(), files, nominal, analyses };
    // The film to be shown comes first, since the size of a page is limited and the films of many tasks do not fit.
    let shown = report::preferred(answer);
    let mut ends = ENDS.map(|(end, _)| end);
    ends.sort_by_key(|end| *end != shown);
    let tasks = 0..answer.record.config.tasks.len();
    for (task, end) in tasks.flat_map(|task| ends.map(|end| (task, end))) {
        if let Some(page) = read(&pair_file(task, end)) {
            files.add(task, end, &page, read(&poster_file(task, end)));
        }
    }
    files
}
