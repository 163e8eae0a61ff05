//! `optimize sensitivity`: Sobol indices of the inputs.

use crate::{Context, Failure, Output, SetupRequest, command, not_stopped};
use analysis::sensitivity::{evaluate, inputs};
use insertion::{DesignError, Measure};
use parameters::plan::saltelli::Sample;
use rayon::prelude::*;
use report::sensitivity::{self as shown, Factor, SensitivityResult};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

/// Rank the inputs by their share of the variance: design, task, cell
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: optimize sensitivity --task usb --space codesign --svg usb.svg")]
pub struct Request {
    /// One task, robot, space and finger model.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// Errors of the cell to vary as well: typical, none, or the path of a file
    #[arg(long, value_name = "NAME", default_value = "typical")]
    pub uncertainty: String,
    /// Rows of the sample; the number of evaluations is this times (inputs + 2)
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(4..=10_000))]
    pub samples: u32,
    /// Seed of the sample
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Write a chart of the shares
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    /// Simulates the sample and ranks the inputs.
    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let _busy = context.busy("simulating the sample");
        let found = self.found(context.stop)?;
        let svg = shown::svg(&found)?;
        Output::new(shown::text(&found), found).drawn(svg, self.svg.as_ref())
    }
}

impl Request {
    fn found(&self, stop: &AtomicBool) -> Result<SensitivityResult, Failure> {
        let mut setup = self.setup.setup()?;
        if self.uncertainty != "none" {
            setup = setup.with_named_uncertainty(&self.uncertainty)?;
        }
        if setup.uncertainty.as_ref().is_some_and(|uncertainty| uncertainty.cell.is_some()) {
            let problem = "--uncertainty takes errors here, not a cell; give the cell with --cell";
            return Err(Failure::usage(problem));
        }
        let template = setup.only_task()?;
        let factors = inputs(&setup.space, setup.uncertainty.as_ref()).map_err(Failure::usage)?;
        let sample = Sample::new(factors.len(), self.samples as usize, self.seed);
        // `None` where the simulation diverged.
        let value = |unit: &Vec<f64>| {
            if stop.load(Ordering::SeqCst) {
                return Ok(None);
            }
            let evaluation = evaluate(&factors, (&setup.evaluator, template), unit, stop)?;
            Ok(Measure::Range.value(&evaluation))
        };
        let points = sample.points();
        let values = points.par_iter().map(value).collect::<Result<Vec<_>, DesignError>>()?;
        not_stopped(stop)?;
        let counted: Vec<f64> = values.iter().map(|value| value.unwrap_or_default()).collect();
        let indices = sample.indices(&counted).ok_or_else(|| {
            let everywhere = Measure::Range.show(counted[0]);
            Failure::running(format!(
                "range is {everywhere} for all inputs, so no share of its variance can be computed"
            ))
        })?;
        Ok(SensitivityResult {
            task: template.task.name.clone(),
            evaluations: values.len(),
            diverged: values.iter().filter(|value| value.is_none()).count(),
            nominal_start_fails: values.iter().filter(|value| **value == Some(0.0)).count(),
            factors: Factor::sorted(&factors, &indices),
        })
    }
}
