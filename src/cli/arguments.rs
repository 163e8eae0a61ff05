//! The options that several commands share, beside those of the requests.

use crate::session::{
    CacheRequest, CalibrateRequest, DEFAULT_PRIORS, EffortRequest, RunRequest, SetupRequest,
};
use clap::Args;
use std::path::PathBuf;

/// How a calibration is computed.
#[derive(Debug, Clone, Args)]
pub struct CalibrationArguments {
    /// What nobody measured, and its bounds: bench, or the path of a file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_PRIORS)]
    priors: String,
    #[command(flatten)]
    effort: EffortRequest,
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
            setup,
            measurements: measurements.to_owned(),
            priors: self.priors.clone(),
            effort: self.effort,
            seed: self.seed,
            cache: CacheRequest { dir: self.cache.clone(), off: self.no_cache },
        }
    }
}

/// How a study is run, as opposed to what it measures.
#[derive(Debug, Args)]
pub struct RunArguments {
    #[command(flatten)]
    run: RunRequest,
    /// Where designs are measured, by the installed Python package: dask://HOST:PORT, slurm,
    /// slurm:JOBS, processes or processes:N [default: on the threads of this process]
    #[arg(long, value_name = "WHERE")]
    pub executor: Option<String>,
    #[command(flatten)]
    effort: EffortRequest,
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
        RunRequest { effort: self.effort, ..self.run.clone() }
    }
}
