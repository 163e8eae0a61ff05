//! `optimize sensitivity`: which unknown matters for the window.

use super::arguments::{SetupArguments, wide};
use super::{Failure, print, print_json};
use crate::report::sensitivity as shown;
use crate::session::SensitivityRequest;
use crate::study::write_file;
use clap::Args;
use insertion::evaluation::objective::Measure;
use insertion::trial::NEVER;
use std::path::PathBuf;

/// Find out which input matters: of the design, the task and the cell.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    setup: SetupArguments,
    /// range or centred-range
    #[arg(long, value_name = "NAME", default_value = "range")]
    objective: Measure,
    /// Errors of the cell that are varied, too: typical, none, or the path of a file
    #[arg(long, value_name = "NAME", default_value = "typical")]
    uncertainty: String,
    /// Rows of the sample: evaluations are this times (inputs + 2)
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(wide(&SensitivityRequest::SAMPLES)))]
    samples: u32,
    /// Seed of the sample
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Write a chart of the shares
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let request = SensitivityRequest {
        setup: arguments.setup.request(),
        objective: arguments.objective,
        uncertainty: Some(arguments.uncertainty.clone()).filter(|name| name != "none"),
        samples: arguments.samples,
        seed: arguments.seed,
    };
    let found = request.run(&NEVER)?;
    if let Some(path) = &arguments.svg {
        let svg = shown::svg(&found).map_err(|error| Failure::running(error.to_string()))?;
        write_file(path, &svg)?;
    }
    if arguments.json { print_json(&shown::json(&found)) } else { print(&shown::text(&found)) }
}
