//! The stiffness model: how stiff a finger of some infill is.

use super::Failure;
use super::files::{printed_finger, stiffness_data, surrogate};
use super::request::DEFAULT_FINGER;
use insertion::surrogate::Model;

/// Which measurements the model is fitted to.
#[derive(Debug, Clone)]
pub struct StiffnessRequest {
    /// Path of a table in place of the one that the finger file names.
    pub stiffness_data: Option<String>,
    /// Finger that was measured: a shipped one, or the path of a file.
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
