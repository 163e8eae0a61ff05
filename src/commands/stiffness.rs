//! `optimize stiffness`: shows the stiffness model and its goodness of fit.

use crate::command;
use crate::context::Context;
use crate::failure::Failure;
use crate::setup::files::{DEFAULT_FINGER, printed_finger, stiffness_data, surrogate};
use crate::setup::finger::InfillRequest;
use insertion::space::Design;
use insertion::surrogate::{Model, Prediction};
use report::stiffness as shown;
use serde::{Serialize, Serializer};
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;
use study::write_file;

/// Show the stiffness model and its leave-one-out errors
#[derive(Debug, Clone, clap::Args)]
#[command(
    display_order = 13,
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

/// Fitted model of the stiffness, with its prediction if an infill is given.
pub struct FittedModel {
    model: Arc<Model>,
    predicted: Option<Prediction>,
}

impl command::Request for Request {
    type Response = FittedModel;

    fn run(&self, _context: &Context<'_>) -> Result<FittedModel, Failure> {
        let given = self.infill != InfillRequest::default();
        let infill = given.then(|| self.infill.required()).transpose()?;
        if let Some([density, direction]) = infill {
            Design::checked_infill(density, direction, "stiffness").map_err(Failure::input)?;
        }
        let finger = printed_finger(&self.finger)?;
        let model = surrogate(&stiffness_data(self.stiffness_data.as_deref(), &finger)?, &finger)?;
        let predict = |infill| model.predict(infill);
        let predicted = infill.map(predict).transpose().map_err(Failure::input)?;
        if let Some(path) = &self.svg {
            write_file(path, &shown::svg(&model)?)?;
        }
        Ok(FittedModel { model, predicted })
    }
}

impl Serialize for FittedModel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.predicted {
            Some(predicted) => predicted.serialize(serializer),
            None => shown::json(&self.model).serialize(serializer),
        }
    }
}

impl command::Response for FittedModel {
    fn picture(&self) -> Result<Option<String>, Failure> {
        Ok(Some(shown::svg(&self.model)?))
    }
}

impl fmt::Display for FittedModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&shown::table(&self.model))
    }
}
