//! Films of trials: of one trial that is asked for, and the pairs at the ends of a study's
//! recommended window.

use super::failure::not_stopped;
use super::{Failure, Setup};
use insertion::evaluation::evaluator::Specimen;
use insertion::evaluation::tolerance::offset;
use insertion::evaluation::{Evaluation, OffsetStep, grid_mm};
use insertion::outcome::Outcome;
use insertion::trial::{Grasp, Recording, Rig};
use rayon::ThreadPool;
use report::answer::Answer;
use report::replay::{self, ENDS, Film, pair_file};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use study::{StudyRecord, write_file, write_own_file};

/// What is made of a recorded trial.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct FilmRequest {
    /// Record the trial: a page that plays it, or a table of every millisecond
    #[arg(long, value_name = "FILE.html|.csv", value_parser = recordable)]
    pub record: Option<PathBuf>,
    /// Draw force against depth
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Keep the page that plays it.
    #[arg(skip)]
    pub page: bool,
}

impl FilmRequest {
    pub(super) fn check(&self) -> Result<(), Failure> {
        let problem =
            |file| filmable(file).map_err(|why| Failure::usage(format!("--record: {why}")));
        self.record.as_deref().map_or(Ok(()), problem)
    }

    /// Records the trial at this offset and writes what was asked for; `None` if nothing was. The page
    /// is there if it is to be kept.
    pub(super) fn record(
        &self,
        rig: &dyn Rig,
        specimen: &Specimen,
        offset_mm: f64,
        stop: &AtomicBool,
    ) -> Result<Option<(Recording, Option<String>)>, Failure> {
        if self.record.is_none() && self.plot.is_none() && !self.page {
            return Ok(None);
        }
        let grasp = Grasp { stop, ..Grasp::of(&specimen.finger) };
        let recording = rig.record(grasp, offset_mm * input::units::MM).ok_or_else(|| {
            Failure::usage("--record and --plot need an engine that simulates: --engine direct")
        })?;
        not_stopped(stop)?;
        let label = shifted(offset_mm);
        let film = film(&label, specimen, &recording);
        let page = || replay::page(&format!("{}, {label}", specimen.task.name), &[film]);
        if let Some(file) = &self.record {
            let content = match extension(file).as_deref() {
                Some("csv") => replay::csv(&recording),
                _ => page(),
            };
            write_file(file, &content)?;
        }
        if let Some(file) = &self.plot {
            write_file(file, &replay::curve_svg(&film)?)?;
        }
        let page = self.page.then(page);
        Ok(Some((recording, page)))
    }

    pub(super) fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.record.iter().chain(&self.plot)
    }
}

fn recordable(text: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(text);
    filmable(&file).map(|()| file)
}

/// Whether a trial can be recorded into a file of this name.
fn filmable(file: &Path) -> Result<(), String> {
    match extension(file).as_deref() {
        Some("html" | "csv") => Ok(()),
        _ => Err("its name must end with .html or .csv, which says what is written".into()),
    }
}

fn extension(file: &Path) -> Option<String> {
    Some(file.extension()?.to_str()?.to_lowercase())
}

fn film<'a>(label: &'a str, specimen: &'a Specimen, recording: &'a Recording) -> Film<'a> {
    Film { label, task: &specimen.task, pad: &specimen.finger.pad, recording }
}

fn shifted(offset_mm: f64) -> String {
    if offset_mm == 0.0 {
        return "nominal start".to_owned();
    }
    format!("start shifted by {offset_mm:+.1} mm")
}

/// Records the pair at each end of the recommended design's windows, the last offset that
/// inserts beside the first that fails, into the study's folder; what an earlier run left there is
/// replaced or, where there is no pair, removed. Ends early once `stop` is set.
pub(super) fn boundary(
    dir: &Path,
    record: &StudyRecord,
    setup: &Setup,
    pool: &ThreadPool,
    stop: &AtomicBool,
) -> Result<(), Failure> {
    // Of a front there is no one finger to show.
    let found = record.config.objective.single().and_then(|_| Answer::of(record).shown());
    for (at, template) in setup.evaluator.templates.iter().enumerate() {
        for (end, outward) in ENDS {
            let file = dir.join(pair_file(at, end));
            let pair =
                match found.as_ref().and_then(|(design, tasks)| Some((*design, *tasks.get(at)?))) {
                    None => None,
                    Some((design, task)) => {
                        let stiffness = setup.evaluator.predict(design).map_err(Failure::input)?;
                        let specimen = setup
                            .evaluator
                            .specimen(template, design, stiffness)
                            .map_err(Failure::input)?;
                        pair(setup, &specimen, task, (end, outward), (pool, stop))?
                    }
                };
            // What was filmed meanwhile is worthless.
            if stop.load(Ordering::SeqCst) {
                return Ok(());
            }
            match pair {
                Some(page) => {
                    let folder = file.parent().unwrap_or(dir);
                    fs::create_dir_all(folder).map_err(|error| {
                        Failure::running(format!("{}: {error}", folder.display()))
                    })?;
                    write_own_file(&file, &page)?;
                }
                // It need not be there.
                None => drop(fs::remove_file(&file)),
            }
        }
    }
    Ok(())
}

/// A page of both trials; `None` if no trial failed there, or the engine shows nothing.
fn pair(
    setup: &Setup,
    specimen: &Specimen,
    measured: &Evaluation,
    (end, outward): (&str, OffsetStep),
    (pool, stop): (&ThreadPool, &AtomicBool),
) -> Result<Option<String>, Failure> {
    let window = &measured.window;
    let (last, failed) = match outward {
        -1 => (window.negative_steps, window.end_negative),
        _ => (window.positive_steps, window.end_positive),
    };
    if window.nominal != Outcome::Inserted || failed.is_none() {
        return Ok(None);
    }
    let rig = setup.evaluator.rig(specimen, measured.taught, 1.0).map_err(Failure::input)?;
    let grasp = Grasp { stop, ..Grasp::of(&specimen.finger) };
    let record = |step| rig.record(grasp, offset(step));
    let (inside, outside) =
        pool.install(|| rayon::join(|| record(last), || record(last + outward)));
    let Some((inside, outside)) = inside.zip(outside) else { return Ok(None) };
    let labels = [last, last + outward].map(|step| shifted(grid_mm(step)));
    let films = [film(&labels[0], specimen, &inside), film(&labels[1], specimen, &outside)];
    let title = format!("{}: the {end} end of the window", specimen.task.name);
    Ok(Some(replay::page(&title, &films)))
}
