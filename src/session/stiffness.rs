//! The stiffness model: how stiff a finger of some infill is.

use super::Failure;
use super::files::{printed_finger, stiffness_data, surrogate};
use super::request::DEFAULT_FINGER;
use insertion::surrogate::Model;

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
    ///
    /// # Errors
    /// If a file cannot be used.
    pub fn model(&self) -> Result<Model, Failure> {
        let finger = printed_finger(&self.finger)?;
        surrogate(&stiffness_data(self.stiffness_data.as_deref(), &finger)?, &finger)
    }
}
