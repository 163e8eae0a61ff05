//! The recommended finger of a study for the printer, written into its folder when it ends.

use super::Failure;
use crate::report::printer::{SHEET, SURFACE, THREE_MF, recommended};
use crate::study::{StudyRecord, write_own_file};
use finray::export::prism::Prism;
use finray::export::{sheet, title};
use finray::mechanics;
use std::path::Path;

/// Writes surface, solid and sheet; nothing if nothing is recommended or its finger cannot be printed.
pub(super) fn write(dir: &Path, record: &StudyRecord) -> Result<(), Failure> {
    let Some(geometry) = recommended(record) else { return Ok(()) };
    if let Ok(prism) = Prism::finger(&geometry) {
        write_own_file(&dir.join(SURFACE), &prism.stl(&title(&geometry)))?;
        let three_mf = prism
            .three_mf(&title(&geometry))
            .map_err(|error| Failure::running(format!("{THREE_MF}: {error}")))?;
        write_own_file(&dir.join(THREE_MF), &three_mf)?;
    }
    if let Ok(stiffness) = mechanics::compute(&geometry) {
        write_own_file(&dir.join(SHEET), &sheet::html(&geometry, &stiffness))?;
    }
    Ok(())
}
