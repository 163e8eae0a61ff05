//! `optimize stiffness`: shows the stiffness model and its leave-one-out errors, or predicts for an infill.

use crate::layout::wrapped;
use crate::setup::files::{DEFAULT_FINGER, stiffness_data, surrogate};
use crate::setup::finger::InfillRequest;
use crate::setup::printed::finger_file;
use crate::{Context, Failure, Output, command};
use input::Check;
use parameters::numbers::{self, DENSITY, DIRECTION};
use report::stiffness as shown;
use serde_json::json;
use std::path::PathBuf;

/// Show the stiffness model and its leave-one-out errors
#[derive(Debug, Clone, clap::Args)]
#[command(
    mut_arg("density", |density| density.hide(true)),
    mut_arg("direction", |direction| direction.hide(true)),
    after_help = "Example: optimize stiffness --stiffness-data mine.csv --svg model.svg"
)]
pub struct Request {
    /// Your own stiffness measurements instead of the shipped ones
    #[arg(long, value_name = "FILE.csv")]
    pub stiffness_data: Option<String>,
    /// Finger that was measured: finray9, or the path of a finger file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_FINGER)]
    pub finger: String,
    /// Also write a plot of the data, the model and its uncertainty
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
    /// Infill whose stiffness is predicted.
    #[command(flatten)]
    pub infill: InfillRequest,
}

impl command::Request for Request {
    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let given = self.infill != InfillRequest::default();
        let infill = given.then(|| self.infill.required("")).transpose()?;
        if let Some([density, direction]) = infill {
            let check = Check { file: "stiffness" };
            numbers::check(check, DENSITY, density)?;
            numbers::check(check, DIRECTION, direction)?;
        }
        let finger = finger_file(&self.finger)?.finger;
        let model = surrogate(&stiffness_data(self.stiffness_data.as_deref(), &finger)?, &finger)?;
        let predicted = infill.map(|infill| model.predict(infill)).transpose()?;
        let value = predicted.map_or_else(|| shown::json(&model), |predicted| json!(predicted));
        let output = Output::new(wrapped(&shown::table(&model)), value);
        // On a terminal the plot is drawn only on request: for fingers computed from their ribs it takes seconds.
        match self.svg.is_some() || !context.is_terminal() {
            true => output.drawn(shown::svg(&model)?, self.svg.as_ref()),
            false => Ok(output),
        }
    }
}
