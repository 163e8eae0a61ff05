//! The recommended finger for the printer: links to the two files that the study wrote beside the page.

use crate::answer::Answer;
use crate::study::StudyRecord;
use finray::export::title;
use finray::geometry::Geometry;
use input::shipped::FINGERS;
use insertion::finger::file::FingerFile;
use maud::{Markup, html};

/// The surface of the recommended finger, in the folder of its study.
pub const SURFACE: &str = "finger.stl";
/// How to print it and how to check the print.
pub const SHEET: &str = "finger-sheet.html";

/// The section; `None` if nothing is recommended.
pub(super) fn section(record: &StudyRecord) -> Option<Markup> {
    let geometry = recommended(record)?;
    Some(html! {
        p {
            a href=(SURFACE) { (SURFACE) } " is " (title(&geometry)) ", with each of its "
            (geometry.ribs) " ribs; both fingers of a gripper are this part. "
            a href=(SHEET) { (SHEET) } " says how to print it and how to check the print. "
            "For other programs and slicers: " code { "optimize export finger" } "."
        }
    })
}

/// The finger file of a study; the shipped one of a study that has none.
pub(super) fn finger_file(record: &StudyRecord) -> Option<FingerFile> {
    record.finger.clone().or_else(|| {
        let shipped = FINGERS.first()?;
        FingerFile::parse(shipped.text, shipped.file).ok()
    })
}

/// The recommended finger; `None` if there is none or it cannot be printed.
pub fn recommended(record: &StudyRecord) -> Option<Geometry> {
    let design = Answer::of(record).verdict.finger()?;
    let finger = finger_file(record)?.with(design).ok()?;
    Geometry::new(&finger, &design.printed(None)).ok()
}
