//! The recommended finger of a study for the printer, written into its folder when it ends.

use crate::failure::Failure;
use finray::export::prism::Prism;
use finray::export::sheet::{self, AtPad};
use finray::export::title;
use finray::mechanics;
use insertion::evaluation::evaluator::Evaluator;
use report::answer::Answer;
use report::printer::{SHEET, SURFACE, THREE_MF, recommended};
use std::path::Path;
use study::{StudyRecord, write_own_file};

/// Writes surface, solid and sheet; nothing if nothing is recommended or its finger cannot be printed.
pub(crate) fn write(
    dir: &Path,
    record: &StudyRecord,
    evaluator: &Evaluator,
) -> Result<(), Failure> {
    let Some(geometry) = recommended(record) else { return Ok(()) };
    if let Ok(prism) = Prism::finger(&geometry) {
        write_own_file(&dir.join(SURFACE), &prism.stl(&title(&geometry)))?;
        let three_mf = prism
            .three_mf(&title(&geometry))
            .map_err(|error| Failure::running(format!("{THREE_MF}: {error}")))?;
        write_own_file(&dir.join(THREE_MF), &three_mf)?;
    }
    if let Ok(ribs) = mechanics::compute(&geometry) {
        let design = Answer::of(record).verdict.finger().cloned();
        let measured =
            design.and_then(|design| evaluator.predict(&design).ok()).map(|p| p.at_pad());
        let at_pad = AtPad { ribs: &ribs, measured };
        write_own_file(&dir.join(SHEET), &sheet::html(&geometry, &at_pad))?;
    }
    Ok(())
}
