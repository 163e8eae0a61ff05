//! One simulated insertion.

use super::Failure;
use super::failure::not_stopped;
use super::film::FilmRequest;
use super::finger::{Chosen, FingerRequest};
use super::repeat::RepeatRequest;
use super::request::SetupRequest;
use crate::study::write_file;
use input::units::MM;
use insertion::evaluation::OffsetStep;
use insertion::trial::{Grasp, Sample, Trial, picture};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

/// Largest offset accepted, mm: far outside any socket.
const LARGEST_OFFSET_MM: f64 = 1000.0;

fn offset(text: &str) -> Result<f64, String> {
    given_offset(text.parse().unwrap_or(f64::NAN))
}

/// Whether the start may be shifted by so much, mm.
fn given_offset(mm: f64) -> Result<f64, String> {
    // Written so that a NaN is outside.
    match mm.abs() <= LARGEST_OFFSET_MM {
        true => Ok(mm),
        false => Err(format!("an offset is a number of mm between ±{LARGEST_OFFSET_MM}")),
    }
}

/// Which insertion to simulate, and what to make of it.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct TrialRequest {
    /// Task, robot, finger model; one task.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// The finger.
    #[command(flatten)]
    pub finger: FingerRequest,
    /// Shift of the start along y, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 0.0,
          value_parser = offset)]
    pub offset_mm: f64,
    /// Repeats at that offset.
    #[command(flatten)]
    pub repeat: Option<RepeatRequest>,
    /// Simulated time between two samples of the course, s, if the course is asked for.
    #[arg(skip)]
    pub every_s: Option<f64>,
    /// What is recorded.
    #[command(flatten)]
    pub film: FilmRequest,
    /// Draw plug, fingertips and socket at the end of each phase
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

/// What a trial gave.
pub struct TrialDone {
    /// The finger on its task.
    pub chosen: Chosen,
    /// Shift of the start along y, mm.
    pub offset_mm: f64,
    /// By how much the task's start was moved before that, grid steps, if it is taught.
    pub taught: Option<OffsetStep>,
    /// How it ended.
    pub trial: Trial,
    /// Its course from the start of the search on, if that was asked for.
    pub samples: Vec<Sample>,
    /// How often each outcome was met in the repeats, if they were asked for.
    pub repeats: Option<BTreeMap<String, usize>>,
    /// Files that were written.
    pub written: Vec<PathBuf>,
}

impl TrialRequest {
    /// Simulates the insertion and writes what was asked for.
    pub fn run(&self, stop: &AtomicBool) -> Result<TrialDone, Failure> {
        let offset_mm = given_offset(self.offset_mm).map_err(|problem| {
            Failure::usage(format!("--offset-mm {}: {problem}", self.offset_mm))
        })?;
        self.film.check()?;
        self.repeat.map_or(Ok(()), RepeatRequest::check)?;
        if self.every_s.is_some_and(|every_s| !(every_s.is_finite() && every_s >= 0.0)) {
            return Err(Failure::usage("every_s: is a time in s, 0 or above"));
        }
        let setup = self.setup.setup()?;
        let chosen = self.finger.choose(&setup)?;
        let specimen = &chosen.specimen;
        let offset = offset_mm * MM;
        let taught = setup.evaluator.taught(specimen, stop).map_err(Failure::input)?;
        let rig = setup.evaluator.rig(specimen, taught, 1.0).map_err(Failure::input)?;
        let filmed = self.film.record(&*rig, specimen, offset_mm, stop)?;
        let grasp = || rig.hold(Grasp { stop, ..Grasp::of(&specimen.finger) });
        let (trial, samples) = match (self.every_s, filmed) {
            (None, Some(recording)) => (recording.trial, Vec::new()),
            (every_s, _) => grasp().sampled(offset, every_s),
        };
        not_stopped(stop)?;
        if let Some(file) = &self.svg {
            let label = format!("{}, start shifted by {offset_mm:+.1} mm", specimen.task.name);
            write_file(file, &picture::svg(&specimen.task, &specimen.finger.pad, &trial, &label))?;
        }
        drop(rig);
        let repeats = self.repeat.as_ref();
        let repeats = repeats
            .map(|repeat| repeat.outcomes(&setup, &chosen, (taught, offset), stop))
            .transpose()?;
        let written = self.svg.iter().chain(self.film.files()).cloned().collect();
        Ok(TrialDone { chosen, offset_mm, taught, trial, samples, repeats, written })
    }
}
