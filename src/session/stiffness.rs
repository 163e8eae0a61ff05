//! The stiffness model: how stiff a finger of some infill is.

use super::Failure;
use super::files::{printed_finger, stiffness_data, surrogate};
use super::request::DEFAULT_FINGER;
use insertion::space::Design;
use insertion::surrogate::{Model, Prediction};

/// Which measurements the model is fitted to.
#[derive(Debug, Clone, clap::Args)]
pub struct StiffnessRequest {
    /// Your own stiffness measurements in place of the shipped ones
    #[arg(long, value_name = "FILE.csv")]
    pub stiffness_data: Option<String>,
    /// Finger that was measured: finray9, or the path of a finger file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_FINGER)]
    pub finger: String,
}

impl Default for StiffnessRequest {
    fn default() -> Self {
        StiffnessRequest { stiffness_data: None, finger: DEFAULT_FINGER.to_owned() }
    }
}

impl StiffnessRequest {
    /// Fits the model.
    pub fn model(&self) -> Result<Model, Failure> {
        let finger = printed_finger(&self.finger)?;
        surrogate(&stiffness_data(self.stiffness_data.as_deref(), &finger)?, &finger)
    }

    /// The stiffness of an infill: density, percent, and direction, degrees.
    pub fn predict(&self, density: f64, direction: f64) -> Result<Prediction, Failure> {
        Design::checked_infill(density, direction, "stiffness").map_err(Failure::input)?;
        self.model()?.predict(density, direction).map_err(Failure::input)
    }
}
