//! The options that studies share, beside those of the requests.

use crate::session::{EffortRequest, RunRequest};
use clap::Args;

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
