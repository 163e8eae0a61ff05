//! The finger and the task of which levers are asked for.

use insertion::evaluation::evaluator::{Evaluator, Specimen};
use insertion::evaluation::template::Template;
use insertion::robot::Robot;
use insertion::space::{Design, Space};
use insertion::surrogate::Prediction;

/// Finger on a task whose levers are measured.
pub struct Question<'a> {
    /// Measures it.
    pub evaluator: &'a Evaluator,
    /// The task; one of the evaluator's.
    pub template: &'a Template,
    /// The space, whose bounds hold for the keys that it has.
    pub space: &'a Space,
    /// The finger, and what else its design sets.
    pub design: &'a Design,
    /// Its stiffness, unless it is to be predicted.
    pub given: Option<Prediction>,
}

/// Specimen and robot of one window.
pub(super) type Cell = (Specimen, Robot);
