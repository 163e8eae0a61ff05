//! Printer files of the recommended finger of a study.

use crate::Failure;
use finray::export::prism::Prism;
use finray::export::sheet::{self, SheetData};
use finray::export::{slicer, title};
use finray::mechanics;
use insertion::Evaluator;
use report::answer::Answer;
use report::printer::{ORCA_PROJECT, PROJECT, SHEET, SURFACE, THREE_MF, recommended};
use std::path::Path;
use study::write_own_file;

/// Writes STL, 3MF, slicer projects and sheet of the recommended finger, as far as it can be printed.
pub(crate) fn write(dir: &Path, answer: &Answer, evaluator: &Evaluator) -> Result<(), Failure> {
    let Some(geometry) = recommended(answer) else { return Ok(()) };
    if let Ok(prism) = Prism::finger(&geometry) {
        write_own_file(&dir.join(SURFACE), &prism.stl(&title(&geometry)))?;
        let three_mf = prism
            .three_mf(&title(&geometry))
            .map_err(|error| Failure::running(format!("{THREE_MF}: {error}")))?;
        write_own_file(&dir.join(THREE_MF), &three_mf)?;
    }
    for (file, project) in [
        (PROJECT, slicer::prusaslicer_project(&geometry)),
        (ORCA_PROJECT, slicer::orcaslicer_project(&geometry)),
    ] {
        let Ok(project) = project else { continue };
        write_own_file(&dir.join(file), &project)?;
    }
    if let Ok(ribs) = mechanics::compute(&geometry) {
        let design = answer.verdict.finger();
        let measured = design.and_then(|design| evaluator.predict(design).ok()).map(|p| p.at_pad());
        let origin = &format!("for {}, {}", answer.record.config.task_name(), study_name(dir));
        let at_pad = SheetData { origin, ribs: &ribs, measured };
        write_own_file(&dir.join(SHEET), &sheet::html(&geometry, &at_pad))?;
    }
    Ok(())
}

/// Returns the name of a study for the sheet of a finger, by its folder: `study usb-gp-seed0`.
pub(crate) fn study_name(dir: &Path) -> String {
    let whole = dir.canonicalize().unwrap_or_else(|_| dir.to_owned());
    format!("study {}", whole.file_name().unwrap_or_default().to_string_lossy())
}
