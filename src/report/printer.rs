//! The recommended finger for the printer: two files beside the page, and their links in it.

use crate::finger::export::prism::Prism;
use crate::finger::export::{sheet, stl, title};
use crate::finger::printed::geometry::Geometry;
use crate::finger::printed::infill::Design;
use crate::finger::printed::mechanics;
use crate::input::finger_file::FingerFile;
use crate::input::shipped::FINGERS;
use crate::study::StudyRecord;
use maud::{Markup, html};

const SURFACE: &str = "finger.stl";
const SHEET: &str = "finger-sheet.html";

/// The files, by their names; none if nothing is recommended or its finger cannot be printed.
pub fn files(record: &StudyRecord) -> Vec<(&'static str, Vec<u8>)> {
    let Some(geometry) = recommended(record) else { return Vec::new() };
    let surface = Prism::finger(&geometry).ok().map(|prism| stl::write(&prism, &title(&geometry)));
    let stiffness = mechanics::compute(&geometry).ok();
    let sheet = stiffness.map(|stiffness| sheet::html(&geometry, &stiffness).into_bytes());
    [(SURFACE, surface), (SHEET, sheet)]
        .into_iter()
        .filter_map(|(name, content)| Some((name, content?)))
        .collect()
}

/// The section; `None` if there are no files.
pub(super) fn section(record: &StudyRecord) -> Option<Markup> {
    let geometry = recommended(record)?;
    Some(html! {
        p {
            a href=(SURFACE) { (SURFACE) } " is " (title(&geometry)) ", with each of its "
            (geometry.ribs()) " ribs; both fingers of a gripper are this part. "
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

fn recommended(record: &StudyRecord) -> Option<Geometry> {
    let design = record.to_print()?;
    let finger = finger_file(record)?.with(design).ok()?;
    Geometry::new(&finger, &Design::of(design, None)).ok()
}
