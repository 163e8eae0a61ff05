//! How something is computed, as opposed to what: threads, cache, effort.

use super::Setup;
use crate::failure::Failure;
use crate::failure::{wide, within};
use calibration::bench::{Effort, Settings};
use rayon::ThreadPool;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use study::{BenchEffort, Cache, Conclusion, IfChanged};

const CACHE: &str = "results/.cache";
const THREADS: RangeInclusive<u16> = 1..=1024;
/// Simulations per task that an emulator may be made of.
const SIMULATIONS: RangeInclusive<u16> = 16..=4096;
const SAMPLES: RangeInclusive<u16> = 20..=20_000;
/// Simulations and samples unless others are asked for.
const EFFORT: BenchEffort = BenchEffort { simulations: 200, samples: 300 };
/// Sweeps before sampling, and from one sample to the next.
const WARM_UP: usize = 300;
const THIN: usize = 4;

/// Where simulations are kept for others, if they are.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct CacheRequest {
    /// Folder of evaluations that studies share; safe to delete [default: results/.cache]
    #[arg(id = "cache", long = "cache", value_name = "DIR")]
    pub dir: Option<PathBuf>,
    /// Measure every design anew, and keep nothing
    #[arg(id = "no_cache", long = "no-cache", conflicts_with = "cache")]
    pub off: bool,
}

impl CacheRequest {
    /// Where simulations of this setup are kept, if they are.
    pub(crate) fn folder(&self, setup: &Setup) -> Result<Option<PathBuf>, Failure> {
        if self.off && self.dir.is_some() {
            return Err(Failure::usage("--cache and --no-cache exclude one another"));
        }
        // A closed formula is faster than a file.
        let default = setup.evaluator.engine.simulates().then(|| PathBuf::from(CACHE));
        Ok(self.dir.clone().or(default).filter(|_| !self.off))
    }
}

/// How much is computed for a prediction of the bench; what is not given is 200 simulations and
/// 300 samples, or as the study has it.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct EffortRequest {
    /// Simulations per task that the emulator of a bench prediction is made of; one in eight
    /// measures its error [default: 200, or as the study has it]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(wide(&SIMULATIONS)))]
    pub simulations: Option<u16>,
    /// Samples of a bench prediction's posterior [default: 300, or as the study has it]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(wide(&SAMPLES)))]
    pub samples: Option<u16>,
}

impl EffortRequest {
    fn check(self) -> Result<(), Failure> {
        within("--simulations", self.simulations, &SIMULATIONS)?;
        within("--samples", self.samples, &SAMPLES)
    }

    /// Simulations per task, unless a study knows better.
    pub(crate) fn count(self) -> usize {
        usize::from(self.simulations.unwrap_or(EFFORT.simulations))
    }

    pub(crate) fn or(self, known: Option<BenchEffort>) -> Result<BenchEffort, Failure> {
        self.check()?;
        let other = known.unwrap_or(EFFORT);
        Ok(BenchEffort {
            simulations: self.simulations.unwrap_or(other.simulations),
            samples: self.samples.unwrap_or(other.samples),
        })
    }
}

pub(crate) fn settings(effort: BenchEffort, seed: u64, stop: &AtomicBool) -> Settings<'_> {
    let effort = Effort { warm_up: WARM_UP, samples: usize::from(effort.samples), thin: THIN };
    Settings { effort, seed, stop, done: &|_| () }
}

/// How a study is run, as opposed to what it measures.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct RunRequest {
    /// Threads [default: one per processor]; changes no result
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(wide(&THREADS)))]
    pub threads: Option<u16>,
    /// Where evaluations are kept for other studies.
    #[command(flatten)]
    pub cache: CacheRequest,
    /// Leave out what confirms the recommendation: the best designs walked, and repeated at their ends
    #[arg(long)]
    pub no_confirm: bool,
    /// Leave out what would help the finger more than its infill
    #[arg(long)]
    pub no_levers: bool,
    /// Leave out the maps of how insertions end over two errors of the start
    #[arg(long)]
    pub no_map: bool,
    /// Go on with a study that was measured by another program version, engine setting or input
    /// file, in a new segment; the best design is then taken from that
    #[arg(long)]
    pub accept_changed: bool,
    /// Where designs are measured, by the installed Python package: dask://HOST:PORT, slurm,
    /// slurm:JOBS, processes or processes:N [default: on the threads of this process]
    // Whoever opens the study hands it over; here threads measure.
    #[arg(long, value_name = "WHERE")]
    pub executor: Option<String>,
    /// How much is computed for the bench.
    #[command(flatten)]
    pub effort: EffortRequest,
}

impl RunRequest {
    pub(crate) fn check(&self) -> Result<(), Failure> {
        within("--threads", self.threads, &THREADS)?;
        self.effort.check()
    }

    /// Treatment of a study that was measured otherwise.
    pub(crate) fn if_changed(&self) -> IfChanged {
        if self.accept_changed { IfChanged::NewSegment } else { IfChanged::Refuse }
    }

    /// How a study of this setup ends; `known` is how much was computed for its bench so far.
    pub(crate) fn conclusion(
        &self,
        setup: &Setup,
        known: Option<BenchEffort>,
    ) -> Result<Conclusion, Failure> {
        let bench = setup.measured.as_ref().map(|_| self.effort.or(known)).transpose()?;
        let measurements = setup.measured.as_ref().map(|measured| measured.file.clone());
        let task_files = setup.task_files.clone();
        Ok(Conclusion { no_confirm: self.no_confirm, bench, measurements, task_files })
    }

    /// How many threads measure; 0 for one per processor.
    pub(crate) fn threads(&self) -> usize {
        usize::from(self.threads.unwrap_or(0))
    }

    pub(crate) fn pool(&self) -> Result<ThreadPool, Failure> {
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads())
            .build()
            .map_err(|error| Failure::running(format!("cannot start the threads: {error}")))
    }

    /// The cache of a study of this setup, if it has one.
    pub(crate) fn cache(&self, setup: &Setup) -> Result<Option<Cache>, Failure> {
        let (robot, engine) = (&setup.evaluator.robot, &setup.evaluator.engine);
        let folder = self.cache.folder(setup)?;
        Ok(folder.map(|dir| Cache::new(&dir, robot, &engine.record())))
    }
}
