//! Input of the lever analysis: finger and task.

use insertion::evaluation::evaluator::{Evaluator, Specimen};
use insertion::evaluation::template::Template;
use insertion::robot::Robot;
use insertion::space::{Design, Space};
use insertion::surrogate::Prediction;

/// Finger and task whose levers are to be measured.
pub struct Question<'a> {
    /// Evaluator for the windows.
    pub evaluator: &'a Evaluator,
    /// The task; one of the evaluator's.
    pub template: &'a Template,
    /// The space. Its bounds take precedence for the keys that it has.
    pub space: &'a Space,
    /// Design of the finger.
    pub design: &'a Design,
    /// Given stiffness of the finger; predicted if `None`.
    pub given: Option<Prediction>,
}

/// Specimen and robot for one window.
pub(super) type Cell = (Specimen, Robot);
