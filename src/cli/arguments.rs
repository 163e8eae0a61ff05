//! The options that several commands share, and the requests that they make.

use crate::session::{
    CacheRequest, CalibrateRequest, DEFAULT_FINGER, DEFAULT_PRIORS, DEFAULT_ROBOT, DEFAULT_SPACE,
    EffortRequest, FilmRequest, FingerRequest, REPEATS, RepeatRequest, RunRequest, SAMPLES,
    SIMULATIONS, SetupRequest, THREADS, TaskSource, filmable, given_stiffness,
};
use clap::Args;
use insertion::finger::model::FingerModelKind;
use insertion::task::StartRule;
use insertion::trial::engine::EngineKind;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// A range as clap takes it of numbers narrower than its own.
pub(super) fn wide<T: Copy + Into<i64>>(range: &RangeInclusive<T>) -> RangeInclusive<i64> {
    (*range.start()).into()..=(*range.end()).into()
}

/// What a trial, an evaluation and a study have in common on the command line.
#[derive(Debug, Clone, clap::Args)]
pub struct SetupArguments {
    /// Task: ket8, ket12, rj45, usb, or the path of a task file; a study may have several, by commas
    #[arg(long, value_name = "NAME")]
    task: String,
    /// Search space: infill, codesign, finger, or the path of a space file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_SPACE)]
    space: String,
    /// Robot: see `optimize tasks`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    robot: String,
    /// Your own stiffness measurements in place of the shipped ones
    #[arg(long, value_name = "FILE.csv")]
    stiffness_data: Option<String>,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    engine: EngineKind,
    #[command(flatten)]
    finger_model: FingerModelArguments,
    /// What becomes of the nominal start, in place of what the task file says
    #[arg(long, value_enum)]
    start: Option<StartRule>,
}

impl SetupArguments {
    /// What is asked for.
    pub fn request(&self) -> SetupRequest {
        let named = SetupRequest {
            tasks: TaskSource::list(&self.task),
            space: self.space.clone(),
            robot: self.robot.clone(),
            stiffness_data: self.stiffness_data.clone(),
            engine: self.engine,
            start: self.start,
            ..SetupRequest::default()
        };
        self.finger_model.of(named)
    }
}

/// Where the springs of a finger come from that were not measured.
#[derive(Debug, Clone, clap::Args)]
pub struct FingerModelArguments {
    /// Where a finger's remote centre and unmeasured springs come from [default: paper; computed
    /// for a space with numbers of the printed finger]
    #[arg(long = "finger-model", value_enum)]
    kind: Option<FingerModelKind>,
    /// Finger file of --finger-model computed: finray9, or the path of one
    #[arg(long, value_name = "NAME", default_value = DEFAULT_FINGER)]
    finger: String,
}

impl FingerModelArguments {
    /// The same request with this finger model.
    pub fn of(&self, setup: SetupRequest) -> SetupRequest {
        SetupRequest { finger_model: self.kind, finger: self.finger.clone(), ..setup }
    }
}

/// Which finger, and on what task.
#[derive(Debug, Clone, Args)]
pub struct FingerArguments {
    /// Infill density, percent
    #[arg(
        long,
        value_name = "PERCENT",
        required_unless_present = "stiffness_compliance",
        allow_negative_numbers = true
    )]
    density: Option<f64>,
    /// Infill direction, degrees
    #[arg(
        long,
        value_name = "DEG",
        required_unless_present = "stiffness_compliance",
        allow_negative_numbers = true
    )]
    direction: Option<f64>,
    /// Stiffness in the compliance direction, N/mm: bypasses the surrogate
    #[arg(long, value_name = "K", requires = "stiffness_assembly", value_parser = stiffness,
          allow_negative_numbers = true)]
    stiffness_compliance: Option<f64>,
    /// Stiffness in the direction of assembly, N/mm: bypasses the surrogate
    #[arg(long, value_name = "K", requires = "stiffness_compliance", value_parser = stiffness,
          allow_negative_numbers = true)]
    stiffness_assembly: Option<f64>,
    /// A number of the task or the finger, as in spaces/codesign.toml; may be given several times
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    set: Vec<(String, f64)>,
}

impl FingerArguments {
    /// What is asked for.
    pub fn request(&self) -> FingerRequest {
        FingerRequest {
            density: self.density,
            direction: self.direction,
            stiffness_compliance: self.stiffness_compliance,
            stiffness_assembly: self.stiffness_assembly,
            set: self.set.clone(),
        }
    }
}

fn stiffness(text: &str) -> Result<f64, String> {
    given_stiffness(text.parse().unwrap_or(f64::NAN))
}

/// A number by its key, as `KEY=VALUE`.
pub(super) fn setting(text: &str) -> Result<(String, f64), String> {
    let parts = text.split_once('=').map(|(key, value)| (key.trim(), value.trim().parse()));
    match parts {
        Some((key, Ok(value))) if !key.is_empty() => Ok((key.to_owned(), value)),
        _ => Err("a setting is KEY=NUMBER, as in task.strategy.tilt_deg=8".to_owned()),
    }
}

/// How often.
#[derive(Debug, Clone, Args)]
pub struct RepeatArguments {
    /// Then N times more with friction within 10 %, start within 0.02 mm, and half the step by turns
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(wide(&REPEATS)))]
    repeat: Option<u32>,
    /// Seed of the repeats
    #[arg(long, value_name = "N", default_value_t = 0, requires = "repeat")]
    repeat_seed: u64,
}

impl RepeatArguments {
    /// What is asked for, if it is.
    pub fn request(&self) -> Option<RepeatRequest> {
        self.repeat.map(|count| RepeatRequest { count, seed: self.repeat_seed })
    }
}

/// What is made of a recorded trial.
#[derive(Debug, Clone, Args)]
pub struct FilmArguments {
    /// Record the trial: a page that plays it, or a table of every millisecond
    #[arg(long, value_name = "FILE.html|.csv", value_parser = recordable)]
    record: Option<PathBuf>,
    /// Draw force against depth
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
}

impl FilmArguments {
    /// What is asked for.
    pub fn request(&self) -> FilmRequest {
        FilmRequest { record: self.record.clone(), plot: self.plot.clone() }
    }
}

fn recordable(text: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(text);
    filmable(&file).map(|()| file)
}

/// How much is computed.
#[derive(Debug, Clone, Copy, Args)]
pub struct EffortArguments {
    /// Simulations per task that the emulator of a bench prediction is made of; one in eight
    /// measures its error [default: 200, or as the study has it]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(wide(&SIMULATIONS)))]
    simulations: Option<u16>,
    /// Samples of a bench prediction's posterior [default: 300, or as the study has it]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(wide(&SAMPLES)))]
    samples: Option<u16>,
}

impl EffortArguments {
    fn request(self) -> EffortRequest {
        EffortRequest { simulations: self.simulations, samples: self.samples }
    }
}

/// How a calibration is computed.
#[derive(Debug, Clone, Args)]
pub struct CalibrationArguments {
    /// What nobody measured, and its bounds: bench, or the path of a file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_PRIORS)]
    priors: String,
    #[command(flatten)]
    effort: EffortArguments,
    /// Seed; the same seed gives the same answer
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Folder of simulations shared with studies; safe to delete [default: results/.cache]
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Simulate anew, and keep nothing
    #[arg(long, conflicts_with = "cache")]
    no_cache: bool,
}

impl CalibrationArguments {
    /// What is asked for, of this setup and these measurements.
    pub fn request(&self, setup: SetupRequest, measurements: &str) -> CalibrateRequest {
        CalibrateRequest {
            priors: self.priors.clone(),
            effort: self.effort.request(),
            seed: self.seed,
            cache: CacheRequest { dir: self.cache.clone(), off: self.no_cache },
            ..CalibrateRequest::new(setup, measurements.to_owned())
        }
    }
}

/// How a study is run, as opposed to what it measures.
#[derive(Debug, Args)]
pub struct RunArguments {
    /// Threads [default: one per processor]; changes no result
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(wide(&THREADS)))]
    threads: Option<u16>,
    /// Folder of evaluations that studies share; safe to delete [default: results/.cache]
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Measure every design anew, and keep nothing
    #[arg(long, conflicts_with = "cache")]
    no_cache: bool,
    /// Leave out what confirms the recommendation: the best designs walked, and repeated at their ends
    #[arg(long)]
    no_confirm: bool,
    /// Go on with a study that was measured by another program version, engine setting or input
    /// file, in a new segment; the best design is then taken from that
    #[arg(long)]
    accept_changed: bool,
    /// Where designs are measured, by the installed Python package: dask://HOST:PORT, slurm,
    /// slurm:JOBS, processes or processes:N [default: on the threads of this process]
    #[arg(long, value_name = "WHERE")]
    pub executor: Option<String>,
    #[command(flatten)]
    effort: EffortArguments,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
    /// Show no progress
    #[arg(long)]
    pub quiet: bool,
}

impl RunArguments {
    /// What is asked for.
    pub fn request(&self) -> RunRequest {
        RunRequest {
            threads: self.threads,
            cache: CacheRequest { dir: self.cache.clone(), off: self.no_cache },
            no_confirm: self.no_confirm,
            accept_changed: self.accept_changed,
            effort: self.effort.request(),
        }
    }
}
