//! `optimize calibrate`: predicts every finger on the bench.

use crate::layout::wrapped;
use crate::progress::cost;
use crate::setup::bench::{BenchRequest, CalibrationRequest, Prepared, folds};
use crate::setup::measured;
use crate::setup::request::several;
use crate::{Context, Failure, Output, command};
use calibration::bench::Settings;
use calibration::calibrate::Calibration;
use calibration::table;
use std::path::PathBuf;
use study::write_file;

/// Predict the range of every finger on the bench: from simulations and a few measurements.
///
/// Simulates the task with drawn values of the parameters that were not measured (friction, preload, robot,
/// finger), compares with the measurements, models the discrepancy as a Gaussian process over the stiffness, and
/// reports the accuracy: each measured finger is predicted without its measurement.
#[derive(Debug, Clone, clap::Args)]
#[command(
    mut_arg("tasks", several),
    after_help = "Example: optimize calibrate --task ket8 --measurements published --out results/ket8-bench"
)]
pub struct Request {
    /// Tasks and measurements.
    #[command(flatten)]
    pub bench: BenchRequest,
    /// Options of the computation.
    #[command(flatten)]
    pub calibration: CalibrationRequest,
    /// Folder for the tables
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let simulations = self.bench.setup.tasks.len().max(1) * self.calibration.simulations();
        context.begin(simulations as f64 * cost::SIMULATION);
        let source = measured::file(&self.bench.measurements)?;
        let Prepared { subjects, layout, settings } =
            self.calibration.prepare((&self.bench, &source), &[], context)?;
        let done = folds(context);
        let found = Calibration::new(layout, &subjects, &Settings { done: &done, ..settings });
        context.check()?;
        let tasks = subjects.iter().zip(&found.tasks);
        let mut text: Vec<String> =
            tasks.map(|(subject, result)| report::calibrate::text(subject, result)).collect();
        text.push(report::calibrate::parameters_text(&found));
        if let Some(out) = &self.out {
            for (subject, result) in subjects.iter().zip(&found.tasks) {
                let name = format!("predictions_{}.csv", subject.task);
                write_file(&out.join(name), &table::predictions_csv(subject, result))?;
            }
            write_file(&out.join("leave_one_out.csv"), &table::left_out_csv(&found, &subjects))?;
            write_file(&out.join("parameters.csv"), &table::parameters_csv(&found))?;
            text.push(format!("tables are in {}\n", out.display()));
        }
        Ok(Output::new(wrapped(&text.join("\n")), table::json(&found, &subjects)))
    }
}
