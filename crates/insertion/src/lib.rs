//! Simulation of insertions: evaluates the finger of a design on a task.
//!
//! ```text
//! task, robot, finger, stiffness -> surrogate -> trial -> evaluation
//! ```
//!
//! A [`task`] is a plug, a socket and a strategy; a [`robot`] carries two fingers; the [`surrogate`]
//! predicts the stiffness of the finger of a design; a [`trial`] is one attempt from one start; an
//! [`evaluation`] is the tolerance window of a design, with the largest force and slip of its trials.
//!
//! "The paper" and "published" refer to Hartisch et al. 2025, arXiv:2509.10012.

pub mod arm;
pub mod evaluation;
pub mod finger;
pub mod outcome;
pub mod robot;
pub mod stiffness;
pub mod surrogate;
pub mod task;
#[cfg(any(test, feature = "fake-engine"))]
pub mod tests;
pub mod trial;

pub use evaluation::cell::Priors;
pub use evaluation::evaluator::{Evaluate, Evaluations, Evaluator, Scenario};
pub use evaluation::objective::{Aggregate, Constraint, Goals, Measure, Objectives, Score};
pub use evaluation::robustness::Plan;
pub use evaluation::robustness::firm::FirmResult;
pub use evaluation::robustness::race::Race;
pub use evaluation::template::{DesignError, Template};
pub use evaluation::tolerance::Search;
pub use evaluation::{Evaluation, OffsetStep, Window, grid_mm};
pub use finger::file::FingerFile;
pub use finger::model::{FingerModelKind, FingerSource};
pub use finger::{Finger, Pad};
pub use outcome::{FailureClass, Outcome};
pub use parameters::space;
pub use robot::Robot;
pub use space::{DENSITY_KEY, DIRECTION_KEY, Design, Space, Variable};
pub use stiffness::Measurement;
pub use surrogate::{Estimate, Prediction};
pub use task::{Ending, Part, Phase, Solid, Stage, StartRule, Strategy, Task};
pub use trial::engine::EngineKind;
pub use trial::{Grasp, Recording, Rig, Tcp, Trial};

/// Returns the name of an option's value on the command line.
pub fn value_name(of: impl clap::ValueEnum) -> String {
    of.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
}
