//! `optimize evaluate`: the tolerance window of one finger.

use super::finger::FingerArguments;
use super::repeat::{self, RepeatArguments};
use super::setup::{Setup, SetupArguments};
use super::summary::{self, evaluation_json, merge};
use super::{Failure, print, print_json};
use clap::Args;
use finger_opt::tolerance::{self, Search};
use serde_json::json;
use std::time::Instant;

/// Measure one finger.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    setup: SetupArguments,
    #[command(flatten)]
    finger: FingerArguments,
    /// Go step by step to the first failure: sees gaps narrower than 0.5 mm, three times the trials
    #[arg(long)]
    walk: bool,
    #[command(flatten)]
    repeat: RepeatArguments,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let setup = Setup::from_arguments(&arguments.setup)?;
    let chosen = arguments.finger.choose(&setup)?;
    let clock = Instant::now();
    let search = if arguments.walk { Search::Walk } else { Search::Strides };
    let rig = setup.rig(&chosen.task).map_err(Failure::input)?;
    let evaluation = tolerance::evaluate(&*rig, &chosen.finger, search);
    let wall_s = clock.elapsed().as_secs_f64();
    let bands = arguments.repeat.bands(&setup, &chosen, &evaluation.window)?;
    if arguments.json {
        let mut fields = chosen.json(&setup, &arguments.finger);
        merge(&mut fields, evaluation_json(&evaluation));
        merge(&mut fields, json!({"wall_s": wall_s}));
        if let Some(bands) = bands {
            merge(&mut fields, json!({"bands": repeat::bands_json(&bands)}));
        }
        return print_json(&fields);
    }
    let counts = evaluation.failure_counts;
    print(&format!(
        "task          {}\n{}\nrange         {:.1} mm\n{}\nfailures      {} of class 1, {} of 2, {} of 3, \
         {} of 4, {} diverged in {} trials\npeak force    {:.1} N\n{}time          {wall_s:.1} s\n",
        chosen.task.name,
        chosen.text(),
        evaluation.window.range_mm(),
        summary::window(&evaluation),
        counts[0],
        counts[1],
        counts[2],
        counts[3],
        evaluation.diverged,
        evaluation.trials,
        evaluation.peak_force_n,
        bands.as_ref().map(repeat::bands_text).unwrap_or_default(),
    ))
}
