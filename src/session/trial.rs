//! One simulated insertion: as it goes, step by step, and its scene for MuJoCo.

use super::Failure;
use super::failure::not_stopped;
use super::film::FilmRequest;
use super::finger::{Chosen, FingerRequest};
use super::repeat::RepeatRequest;
use super::request::SetupRequest;
use calibration::identify::curves::STEP_S;
use calibration::identify::log::of_samples;
use contact::mjcf::{self, MjcfSettings};
use input::units::MM;
use insertion::evaluation::evaluator::Specimen;
use insertion::evaluation::{OffsetStep, tolerance};
use insertion::outcome::Outcome;
use insertion::trial::{Course, Driven, Grasp, Probe, Sample, State, Trial, cell, picture};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use study::write_file;

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
    /// Write force and pose at 500 Hz, as a robot logs them, from the search on
    #[arg(long, value_name = "FILE.csv")]
    pub log: Option<PathBuf>,
    /// In place of an insertion, slide the part on a flat plate: 8 mm along y and back at 5 N, for `identify`
    #[arg(long, requires = "log", conflicts_with_all = ["repeat", "svg", "record", "plot"])]
    pub probe: bool,
    /// Draw plug, fingertips and socket at the end of each phase
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

/// Result of a trial.
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
    /// The page that plays it, if it is to be kept.
    pub page: Option<String>,
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
        let (filmed, page) = filmed.map_or((None, None), |(filmed, page)| (Some(filmed), page));
        let grasp = Grasp { stop, ..Grasp::of(&specimen.finger) };
        let (trial, samples) = match (self.every_s, filmed) {
            _ if self.probe => {
                let rig = setup.evaluator.rig(specimen, None, 1.0).map_err(Failure::input)?;
                let probed = rig.follow(grasp, Course::Probe(Probe::USUAL), STEP_S);
                probed.into_iter().next().ok_or_else(undriven)?
            }
            _ if self.log.is_some() => rig.hold(grasp).logged(offset, STEP_S),
            (None, Some(recording)) => (recording.trial, Vec::new()),
            (every_s, _) => rig.hold(grasp).sampled(offset, every_s),
        };
        not_stopped(stop)?;
        if let Some(file) = &self.log {
            let log = of_samples(&file.to_string_lossy(), &samples).map_err(Failure::input)?;
            write_file(file, &log.csv())?;
        }
        if let Some(file) = &self.svg {
            let label = format!("{}, start shifted by {offset_mm:+.1} mm", specimen.task.name);
            write_file(file, &picture::svg(&specimen.task, &specimen.finger.pad, &trial, &label))?;
        }
        drop(rig);
        let outcomes = |repeat: RepeatRequest| {
            repeat.of(&setup, specimen, taught, stop, |repeats| repeats.outcomes(offset))
        };
        let repeats = self.repeat.map(outcomes).transpose()?.map(|outcomes| {
            let mut counts = BTreeMap::new();
            for outcome in outcomes {
                let word = match outcome {
                    Outcome::Failed(class) => format!("failed: {}", class.label()),
                    outcome => outcome.word().to_owned(),
                };
                *counts.entry(word).or_default() += 1;
            }
            counts
        });
        let written = self.svg.iter().chain(&self.log).chain(self.film.files()).cloned().collect();
        Ok(TrialDone { chosen, offset_mm, taught, trial, samples, repeats, page, written })
    }
}

fn undriven() -> Failure {
    Failure::usage("this engine simulates nothing that could be driven; use --engine direct")
}

/// A grasped part in front of its socket, which a caller commands step by step: no command of the
/// command line has it.
pub struct Insertion {
    driven: Driven,
    /// The taught start, m.
    taught: f64,
}

impl Insertion {
    /// A part between these fingers.
    ///
    /// # Errors
    /// If task, robot and finger cannot be simulated, or the engine simulates nothing; if `stop` is
    /// set meanwhile.
    pub fn new(
        setup: &SetupRequest,
        finger: &FingerRequest,
        stop: &AtomicBool,
    ) -> Result<Self, Failure> {
        let setup = setup.setup()?;
        let specimen = finger.choose(&setup)?.specimen;
        let taught = setup.evaluator.taught(&specimen, stop).map_err(Failure::input)?;
        let rig = setup.evaluator.rig(&specimen, None, 1.0).map_err(Failure::input)?;
        let grasp = Grasp { stop, ..Grasp::of(&specimen.finger) };
        let driven = rig.driven(grasp).ok_or_else(undriven)?;
        not_stopped(stop)?;
        Ok(Insertion { driven, taught: taught.map_or(0.0, tolerance::offset) })
    }

    /// Begins anew, with the start shifted by so much along y, mm.
    pub fn start(&mut self, offset_mm: f64) -> State {
        self.driven.start(self.taught + offset_mm * MM)
    }

    /// Commands a velocity of the TCP, mm/s, for a control step.
    pub fn step(&mut self, velocity_mm_per_s: [f64; 3]) -> State {
        self.driven.step(Vector3::from(velocity_mm_per_s) * MM)
    }
}

/// Which scene to write.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SceneRequest {
    /// Task, robot, finger model; one task.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// The finger.
    #[command(flatten)]
    pub finger: FingerRequest,
}

impl SceneRequest {
    /// Name of the task, and the scene as MJCF.
    pub fn mjcf(&self) -> Result<(String, String), Failure> {
        let setup = self.setup.setup()?;
        let Specimen { task, finger, .. } = self.finger.choose(&setup)?.specimen;
        let robot = &setup.evaluator.robot;
        let mounted = robot.mount(task.turn, task.strategy.tilt).map_err(Failure::input)?;
        let scene = cell::build(&task, &mounted, &finger).scene;
        let instead = match scene.patched() {
            Some(_) => "give finger_plug_torsion_mm in mm",
            None => "--robot servo and --robot rigid need none of it",
        };
        let text = mjcf::write(&scene, &task.name, &MjcfSettings::default())
            .map_err(|error| Failure::usage(format!("{error}; {instead}")))?;
        Ok((task.name, text))
    }
}
