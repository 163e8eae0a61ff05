//! Which unknown matters for the window.

use super::failure::{not_stopped, wide, within};
use super::request::SetupRequest;
use super::{Failure, Setup};
use crate::report::sensitivity::Found;
use crate::sensitivity::factors::Factors;
use crate::sensitivity::sobol::Sample;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::template::Impossible;
use rayon::prelude::*;
use std::ops::RangeInclusive;
use std::sync::atomic::AtomicBool;

/// Rows there may be.
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
    ///
    /// # Errors
    /// If a file cannot be used, an input cannot be varied, or the objective is the same everywhere;
    /// if `stop` is set meanwhile.
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
        setup.only_task()?;
        let errors = setup.uncertainty.as_ref().map(|uncertainty| &uncertainty.errors);
        let factors = Factors::new(&setup.space, errors).map_err(Failure::usage)?;
        self.rank(&setup, &factors, stop)
    }

    fn rank(&self, setup: &Setup, factors: &Factors, stop: &AtomicBool) -> Result<Found, Failure> {
        let inputs = factors.0.len();
        let sample = Sample::new(inputs, self.samples as usize, self.seed);
        let values = self.values(setup, factors, &sample.points(), stop)?;
        not_stopped(stop)?;
        let indices = sample.indices(&counted(&values)).ok_or_else(|| {
            Failure::running(format!(
                "{} is {} for every input: nothing matters",
                self.objective,
                self.objective.show(counted(&values)[0])
            ))
        })?;
        Ok(Found {
            task: setup.only_task()?.task.name.clone(),
            objective: self.objective,
            factors: factors.0.clone(),
            indices,
            evaluations: values.len(),
            diverged: values.iter().filter(|value| value.is_none()).count(),
            without_window: values.iter().filter(|value| **value == Some(0.0)).count(),
        })
    }

    /// The objective at every point, `None` where the nominal start diverged.
    fn values(
        &self,
        setup: &Setup,
        factors: &Factors,
        points: &[Vec<f64>],
        stop: &AtomicBool,
    ) -> Result<Vec<Option<f64>>, Failure> {
        let template = setup.only_task()?;
        let value = |unit: &Vec<f64>| {
            let evaluation = factors.evaluate(&setup.evaluator, template, unit, stop)?;
            Ok(self.objective.value(&evaluation))
        };
        let values: Result<Vec<_>, Impossible> = points.par_iter().map(value).collect();
        values.map_err(Failure::input)
    }
}

/// A start that diverged counts as 0.
fn counted(values: &[Option<f64>]) -> Vec<f64> {
    values.iter().map(|value| value.unwrap_or_default()).collect()
}
