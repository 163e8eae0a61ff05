//! Which unknown matters for the window.

use super::Failure;
use super::failure::{not_stopped, wide, within};
use super::request::SetupRequest;
use analysis::sensitivity::factors::Factors;
use analysis::sensitivity::sobol::Sample;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::template::Impossible;
use rayon::prelude::*;
use report::sensitivity::Found;
use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicBool, Ordering};

const SAMPLES: RangeInclusive<u32> = 4..=10_000;

/// What to vary, and what is looked at.
#[derive(Debug, Clone, clap::Args)]
pub struct SensitivityRequest {
    /// Task, robot, space, finger model; one task.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// range or centred-range
    #[arg(long, value_name = "NAME", default_value = "range")]
    pub objective: Measure,
    /// Errors of the cell that are varied, too: typical, none, or the path of a file
    #[arg(long, value_name = "NAME", default_value = "typical")]
    pub uncertainty: String,
    /// Rows of the sample: evaluations are this times (inputs + 2)
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(wide(&SAMPLES)))]
    pub samples: u32,
    /// Seed of the sample
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
}

impl SensitivityRequest {
    /// Simulates the sample and ranks the inputs.
    pub fn run(&self, stop: &AtomicBool) -> Result<Found, Failure> {
        if !matches!(self.objective, Measure::Range | Measure::CentredRange) {
            let problem = "has no value where nothing inserts; use range or centred-range";
            return Err(Failure::usage(format!("--objective {} {problem}", self.objective)));
        }
        within("--samples", self.samples, &SAMPLES)?;
        let mut setup = self.setup.setup()?;
        if self.uncertainty != "none" {
            setup = setup.under_named(&self.uncertainty)?;
        }
        if setup.uncertainty.as_ref().is_some_and(|uncertainty| uncertainty.cell.is_some()) {
            return Err(Failure::usage(
                "--uncertainty: varies errors here, no cell; give the cell by --cell",
            ));
        }
        let template = setup.only_task()?;
        let errors = setup.uncertainty.as_ref().map(|uncertainty| &uncertainty.errors);
        let factors = Factors::new(&setup.space, errors).map_err(Failure::usage)?;
        let sample = Sample::new(factors.0.len(), self.samples as usize, self.seed);
        // `None` where the nominal start diverged.
        let value = |unit: &Vec<f64>| {
            if stop.load(Ordering::SeqCst) {
                return Ok(None);
            }
            let evaluation = factors.evaluate(&setup.evaluator, template, unit, stop)?;
            Ok(self.objective.value(&evaluation))
        };
        let values: Result<Vec<Option<f64>>, Impossible> =
            sample.points().par_iter().map(value).collect();
        let values = values.map_err(Failure::input)?;
        not_stopped(stop)?;
        let counted: Vec<f64> = values.iter().map(|value| value.unwrap_or_default()).collect();
        let indices = sample.indices(&counted).ok_or_else(|| {
            let everywhere = self.objective.show(counted[0]);
            let problem = format!("is {everywhere} for every input: nothing matters");
            Failure::running(format!("{} {problem}", self.objective))
        })?;
        Ok(Found {
            task: template.task.name.clone(),
            objective: self.objective,
            indices,
            evaluations: values.len(),
            diverged: values.iter().filter(|value| value.is_none()).count(),
            without_window: values.iter().filter(|value| **value == Some(0.0)).count(),
            factors: factors.0,
        })
    }
}
