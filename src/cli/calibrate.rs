//! `optimize calibrate`: what few measurements say of every finger.

use super::progress::Progress;
use super::{Failure, print, print_json};
use crate::calibration::table;
use crate::session::{CalibrateRequest, Calibrated};
use crate::study::write_file;
use clap::Args;
use insertion::trial::NEVER;
use std::path::PathBuf;

/// Predict what every finger does on the bench, from simulation and few measurements.
///
/// Simulates the task under what nobody measured (friction, preload, robot, finger), compares
/// with the measurements, learns what no parameter explains as a process over the stiffness, and
/// says how far the result is to be trusted: each measured finger predicted without it.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: CalibrateRequest,
    /// Folder that tables are written to
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
    /// Say nothing while it simulates
    #[arg(long)]
    quiet: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let quiet = arguments.quiet || arguments.json;
    let mut progress = Progress::of_simulations(arguments.request.simulations(), quiet);
    let see = &mut |event: crate::session::Event<'_>| progress.see(event);
    let Calibrated { subjects, found } = arguments.request.run(&NEVER, see)?;
    drop(progress);
    if let Some(out) = &arguments.out {
        for (subject, result) in subjects.iter().zip(&found.tasks) {
            let name = format!("predictions_{}.csv", subject.task);
            write_file(&out.join(name), &table::predictions_csv(subject, result))?;
        }
        write_file(&out.join("leave_one_out.csv"), &table::left_out_csv(&found, &subjects))?;
        write_file(&out.join("parameters.csv"), &table::parameters_csv(&found))?;
    }
    if arguments.json {
        return print_json(&table::json(&found, &subjects));
    }
    let tasks = subjects.iter().zip(&found.tasks);
    let mut text: Vec<String> =
        tasks.map(|(subject, result)| table::text(subject, result)).collect();
    text.push(table::parameters_text(&found));
    if let Some(out) = &arguments.out {
        text.push(format!("tables are in {}\n", out.display()));
    }
    print(&text.join("\n"))
}
