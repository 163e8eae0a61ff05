//! `optimize calibrate`: what few measurements say of every finger.

use super::progress::Progress;
use super::{Failure, print, print_json};
use crate::session::{CalibrateRequest, Calibrated};
use calibration::table;
use clap::Args;
use insertion::trial::NEVER;
use serde_json::Value;
use std::path::{Path, PathBuf};
use study::write_file;

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

/// Output of `--json`; the tables are written to `out`.
pub fn written(calibrated: &Calibrated, out: Option<&Path>) -> Result<Value, Failure> {
    let Calibrated { subjects, found } = calibrated;
    if let Some(out) = out {
        for (subject, result) in subjects.iter().zip(&found.tasks) {
            let name = format!("predictions_{}.csv", subject.task);
            write_file(&out.join(name), &table::predictions_csv(subject, result))?;
        }
        write_file(&out.join("leave_one_out.csv"), &table::left_out_csv(found, subjects))?;
        write_file(&out.join("parameters.csv"), &table::parameters_csv(found))?;
    }
    Ok(table::json(found, subjects))
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let quiet = arguments.quiet || arguments.json;
    let mut progress = Progress::of_simulations(arguments.request.simulations(), quiet);
    let see = &mut |event: crate::session::Event<'_>| progress.see(event);
    let calibrated = arguments.request.run(&NEVER, see)?;
    drop(progress);
    let json = written(&calibrated, arguments.out.as_deref())?;
    if arguments.json {
        return print_json(&json);
    }
    let Calibrated { subjects, found } = calibrated;
    let tasks = subjects.iter().zip(&found.tasks);
    let mut text: Vec<String> =
        tasks.map(|(subject, result)| table::text(subject, result)).collect();
    text.push(table::parameters_text(&found));
    if let Some(out) = &arguments.out {
        text.push(format!("tables are in {}\n", out.display()));
    }
    print(&text.join("\n"))
}
