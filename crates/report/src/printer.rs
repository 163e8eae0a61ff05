//! The recommended finger for the printer: the files that the study wrote beside the page.

use crate::answer::Answer;
use finray::geometry::Geometry;
use input::shipped::FINGERS;
use insertion::finger::file::{FingerFile, infill};
use study::StudyRecord;

/// The surface of the recommended finger, in the folder of its study.
pub const SURFACE: &str = "finger.stl";
/// The same with its unit.
pub const THREE_MF: &str = "finger.3mf";
/// How to print it and how to check the print.
pub const SHEET: &str = "finger-sheet.html";
/// The files with their names for readers.
pub const FILES: [(&str, &str); 3] =
    [(SURFACE, SURFACE), (THREE_MF, "3MF"), (SHEET, "print sheet")];

/// The finger file of a study; the shipped one of a study that has none.
pub(super) fn finger_file(record: &StudyRecord) -> Option<FingerFile> {
    record.finger.clone().or_else(|| {
        let shipped = FINGERS.first()?;
        FingerFile::parse(shipped.text, shipped.file).ok()
    })
}

/// The recommended finger; `None` if there is none or it cannot be printed.
pub fn recommended(answer: &Answer) -> Option<Geometry> {
    let design = answer.verdict.finger()?;
    let finger = finger_file(answer.record)?.with(design).ok()?;
    Geometry::new(&finger, &infill(design, None)).ok()
}
