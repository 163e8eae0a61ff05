//! Files for printing the recommended finger, beside the page.

use crate::answer::Answer;
use finray::geometry::Geometry;
use input::shipped::FINGERS;
use insertion::FingerFile;
use insertion::finger::file::infill;
use study::StudyRecord;

/// Triangle mesh of the recommended finger with its ribs, in the folder of its study.
pub const SURFACE: &str = "finger.stl";
/// The same mesh in a format that contains its unit of length.
pub const THREE_MF: &str = "finger.3mf";
/// Outline and solid base, from which PrusaSlicer makes the ribs as infill by the settings in the file.
pub const PROJECT: &str = "finger-prusaslicer.3mf";
/// The same with settings of OrcaSlicer and Bambu Studio.
pub const ORCA_PROJECT: &str = "finger-orcaslicer.3mf";
/// Sheet with instructions for printing the finger and checking the print.
pub const SHEET: &str = "finger-sheet.html";
/// Files with their labels.
pub const FILES: [(&str, &str); 5] = [
    (PROJECT, "3MF Prusa"),
    (ORCA_PROJECT, "3MF Orca/Bambu"),
    (THREE_MF, "3MF ribs"),
    (SURFACE, "STL ribs"),
    (SHEET, "print sheet"),
];

/// Returns the finger file of a study, or the shipped one if the study has none.
pub(super) fn finger_file(record: &StudyRecord) -> Option<FingerFile> {
    record.finger.clone().or_else(|| FingerFile::parse(FINGERS[0].text, FINGERS[0].file).ok())
}

/// Returns the geometry of the recommended finger; `None` if there is none or it cannot be built.
pub fn recommended(answer: &Answer) -> Option<Geometry> {
    let design = answer.verdict.finger()?;
    Geometry::new(&finger_file(answer.record)?.with(design).ok()?, &infill(design, None)).ok()
}
