//! Recordings of trials: a page that plays them (film), and a plot.

use crate::{Failure, not_stopped};
use insertion::{Grasp, Recording, Rig, Scenario};
use report::replay::{self, Film};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use study::write_file;

/// Options of a trial: outputs made from its recording.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct FilmRequest {
    /// Record the trial: a page that plays it
    #[arg(long, value_name = "FILE.html", value_parser = recordable)]
    pub record: Option<PathBuf>,
    /// Draw force against depth
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Include the page that plays the trial in the result
    #[arg(long = "film", hide = true)]
    pub page: bool,
}

impl FilmRequest {
    /// Records the trial at this offset and writes the requested outputs; returns the recording (`None` if no
    /// output was requested), and the page if it was requested.
    pub(crate) fn record(
        &self,
        rig: &dyn Rig,
        scenario: &Scenario,
        offset_mm: f64,
        stop: &AtomicBool,
    ) -> Result<(Option<Recording>, Option<String>), Failure> {
        if self.record.is_none() && self.plot.is_none() && !self.page {
            return Ok((None, None));
        }
        let grasp = Grasp { stop, ..Grasp::of(&scenario.finger) };
        let recording = rig.record(grasp, offset_mm * input::units::MM).ok_or_else(|| {
            Failure::usage("--record and --plot need an engine that simulates: --engine direct")
        })?;
        not_stopped(stop)?;
        let label = &start_label(offset_mm);
        let (task, pad) = (&scenario.task, &scenario.finger.pad);
        let film = Film { label, task, pad, recording: &recording };
        let page = || replay::page(&format!("{}, {label}", scenario.task.name), &[film]);
        if let Some(file) = &self.record {
            write_file(file, &page())?;
        }
        if let Some(file) = &self.plot {
            write_file(file, &replay::curve_svg(&film)?)?;
        }
        let page = self.page.then(page);
        Ok((Some(recording), page))
    }

    /// Returns the files of the requested outputs.
    pub(crate) fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.record.iter().chain(&self.plot)
    }
}

/// Parses the name of a file into which a trial can be recorded.
fn recordable(text: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(text);
    match &*extension(&file) {
        "html" => Ok(file),
        _ => Err("the name must end with .html; --log writes force and pose as CSV".into()),
    }
}

/// Returns the extension of a file, in lower case.
pub(crate) fn extension(file: &Path) -> String {
    file.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Returns the label of a start shifted along y.
pub(crate) fn start_label(offset_mm: f64) -> String {
    match offset_mm == 0.0 {
        true => "nominal start".to_owned(),
        false => format!("start shifted by {offset_mm:+.1} mm"),
    }
}
