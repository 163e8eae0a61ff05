//! Options of a run that change no evaluation: threads, cache, analyses after a study and their effort.

use super::Setup;
use crate::failure::Failure;
use calibration::bench::Settings;
use input::shipped::nearest;
use rayon::ThreadPool;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use study::{AnalysisSettings, BenchEffort, Cache};

/// Accepted numbers of threads.
pub const THREADS: RangeInclusive<i64> = 1..=1024;
const CACHE: &str = "results/.cache";
/// Default effort of a bench prediction.
const EFFORT: BenchEffort = BenchEffort { simulations: 200, samples: 300 };
/// Sweeps of the sampler before the first sample (`WARM_UP`) and from one sample to the next (`THIN`).
const WARM_UP: usize = 300;
const THIN: usize = 4;

/// Cache of simulations.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct CacheRequest {
    /// Folder of evaluations that studies share; safe to delete [default: results/.cache]
    #[arg(id = "cache", long = "cache", value_name = "DIR")]
    pub dir: Option<PathBuf>,
    /// Measure every design again and store nothing
    #[arg(id = "no_cache", long = "no-cache", conflicts_with = "cache")]
    pub off: bool,
}

impl CacheRequest {
    /// Returns the folder of the cache, if there is one.
    pub(crate) fn folder(&self, setup: &Setup) -> Option<PathBuf> {
        // An engine that does not simulate evaluates a formula, which is faster than reading a file.
        let default = setup.evaluator.engine.simulates().then(|| PathBuf::from(CACHE));
        self.dir.clone().or(default).filter(|_| !self.off)
    }
}

/// Effort of a bench prediction: by default 200 simulations and 300 samples, or that of the study.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct EffortRequest {
    /// Simulations per task for the emulator of a bench prediction; one in eight measures its error
    /// [default: 200, or as in the study]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(16..=4096))]
    pub simulations: Option<u16>,
    /// Samples of the posterior of a bench prediction [default: 300, or as in the study]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(20..=20_000))]
    pub samples: Option<u16>,
}

impl EffortRequest {
    /// Returns the effort; values not given are those of the study, or else the defaults.
    pub(crate) fn completed(self, of_study: Option<BenchEffort>) -> BenchEffort {
        let other = of_study.unwrap_or(EFFORT);
        BenchEffort {
            simulations: self.simulations.unwrap_or(other.simulations),
            samples: self.samples.unwrap_or(other.samples),
        }
    }
}

pub(crate) fn settings(effort: BenchEffort, seed: u64, stop: &AtomicBool) -> Settings<'_> {
    let samples = usize::from(effort.samples);
    Settings { warm_up: WARM_UP, samples, thin: THIN, seed, stop, done: &|_| () }
}

/// Options of the run of a study that change no evaluation.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct RunRequest {
    /// Threads [default: one per processor]; changes no result
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(THREADS))]
    pub threads: Option<u16>,
    /// Cache of evaluations.
    #[command(flatten)]
    pub cache: CacheRequest,
    /// Skip the confirmation of the best designs (windows measured step by step and repeated at their ends)
    #[arg(long)]
    pub no_confirm: bool,
    /// Skip the one-at-a-time sensitivity analysis of the recommended finger (levers)
    #[arg(long)]
    pub no_levers: bool,
    /// Skip the maps of outcomes over two errors of the start
    #[arg(long)]
    pub no_map: bool,
    /// Continue a study of another program version, engine setting or input file in a new segment; the
    /// best design is then taken from that segment
    #[arg(long)]
    pub accept_changed: bool,
    /// Executor that measures designs, through the installed Python package: dask://HOST:PORT, slurm,
    /// slurm:JOBS, processes or processes:N [default: the threads of this process]
    #[arg(long, value_name = "WHERE", value_parser = executor)]
    pub executor: Option<String>,
    /// Effort of the bench prediction.
    #[command(flatten)]
    pub effort: EffortRequest,
    /// Project file and the options set by it, recorded in study.toml
    #[arg(long, hide = true)]
    pub project: Option<String>,
}

/// Kinds of executors; after a colon follows an address or a number of jobs or processes.
const EXECUTORS: [&str; 3] = ["dask", "slurm", "processes"];

fn executor(text: &str) -> Result<String, String> {
    let (kind, _) = text.split_once(':').unwrap_or((text, ""));
    if EXECUTORS.contains(&kind) {
        return Ok(text.to_owned());
    }
    let near = nearest(kind, &EXECUTORS).map(|near| format!("; did you mean `{near}`?"));
    let forms = "dask://HOST:PORT, slurm, slurm:JOBS, processes or processes:N";
    Err(format!("must be {forms}{}", near.unwrap_or_default()))
}

impl RunRequest {
    /// Returns the settings of the analyses after a study; `effort` is that of its bench prediction so far.
    pub(crate) fn analyses(&self, setup: &Setup, effort: Option<BenchEffort>) -> AnalysisSettings {
        let bench = setup.measured.as_ref().map(|_| self.effort.completed(effort));
        let measurements = setup.measured.as_ref().map(|measured| measured.file.clone());
        let (task_files, robot_file) = (setup.task_files.clone(), setup.robot_file.clone());
        let (no_confirm, project) = (self.no_confirm, self.project.clone());
        AnalysisSettings { no_confirm, bench, measurements, task_files, robot_file, project }
    }

    /// Returns the number of threads; 0 for one per processor.
    pub(crate) fn threads(&self) -> usize {
        usize::from(self.threads.unwrap_or(0))
    }

    pub(crate) fn pool(&self) -> Result<ThreadPool, Failure> {
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads())
            .build()
            .map_err(|error| Failure::running(format!("cannot start the threads: {error}")))
    }

    /// Returns the cache of a setup, if there is one.
    pub(crate) fn cache(&self, setup: &Setup) -> Option<Cache> {
        let (robot, engine) = (&setup.evaluator.robot, &setup.evaluator.engine);
        self.cache.folder(setup).map(|dir| Cache::new(&dir, robot, &engine.record()))
    }
}
