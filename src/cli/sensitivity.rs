//! `optimize sensitivity`: which unknown matters for the window.

use super::setup::{self, Setup, SetupArguments};
use super::{Failure, print, print_json};
use crate::report::sensitivity as shown;
use crate::sensitivity::factors::Factors;
use crate::sensitivity::sobol::Sample;
use crate::study::write_file;
use clap::Args;
use input::shipped::UNCERTAINTIES;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::template::Impossible;
use rayon::prelude::*;
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
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(4..=10_000))]
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
    if !matches!(arguments.objective, Measure::Range | Measure::CentredRange) {
        let problem = "has no value where nothing inserts; use range or centred-range";
        return Err(Failure::usage(format!("--objective {} {problem}", arguments.objective)));
    }
    let mut setup = Setup::from_arguments(&arguments.setup)?;
    if arguments.uncertainty != "none" {
        setup = setup.under(setup::find("uncertainty", UNCERTAINTIES, &arguments.uncertainty)?)?;
    }
    setup.only_task()?;
    let errors = setup.uncertainty.as_ref().map(|uncertainty| &uncertainty.errors);
    let factors = Factors::new(&setup.space, errors).map_err(Failure::usage)?;
    let found = arguments.rank(&setup, &factors)?;
    if let Some(path) = &arguments.svg {
        let svg = shown::svg(&found).map_err(|error| Failure::running(error.to_string()))?;
        write_file(path, &svg)?;
    }
    if arguments.json { print_json(&shown::json(&found)) } else { print(&shown::text(&found)) }
}

impl Arguments {
    fn rank(&self, setup: &Setup, factors: &Factors) -> Result<shown::Found, Failure> {
        let inputs = factors.0.len();
        let sample = Sample::new(inputs, self.samples as usize, self.seed);
        let values = self.values(setup, factors, &sample.points())?;
        let indices = sample.indices(&counted(&values)).ok_or_else(|| {
            Failure::running(format!(
                "{} is {} for every input: nothing matters",
                self.objective,
                self.objective.show(counted(&values)[0])
            ))
        })?;
        Ok(shown::Found {
            task: setup.only_task()?.task().name.clone(),
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
    ) -> Result<Vec<Option<f64>>, Failure> {
        let template = setup.only_task()?;
        let value = |unit: &Vec<f64>| {
            let evaluation = factors.evaluate(&setup.evaluator, template, unit)?;
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
