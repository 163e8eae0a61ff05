//! The window of a finger as computed from its ribs, beside that of the default model: on which
//! of the two the bench agrees depends on the task (`docs/finger.md`).

use super::Failure;
use super::setup::{Setup, SetupArguments};
use super::specimen::FingerArguments;
use crate::evaluation::Evaluation;
use crate::evaluation::robustness::Plan;
use crate::evaluation::tolerance::Search;
use crate::finger::model::FingerModelKind;
use crate::outcome::Outcome;
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// What the computed finger does.
pub enum ComputedToo {
    /// It was measured.
    Measured(Box<Evaluation>),
    /// It cannot be, and why.
    Refused(String),
}

/// Measures the finger once more, from its ribs; nothing if a finger model was asked for, if the finger
/// is given by its springs, or if the engine has no such fingers.
pub fn measure(
    arguments: &SetupArguments,
    finger: &FingerArguments,
    search: Search,
) -> Option<ComputedToo> {
    if arguments.finger_model.kind.is_some() || finger.springs_are_given() {
        return None;
    }
    let mut arguments = arguments.clone();
    arguments.finger_model.kind = Some(FingerModelKind::Computed);
    let setup = Setup::from_arguments(&arguments).ok()?;
    let measured = finger.choose(&setup).and_then(|chosen| {
        let never = AtomicBool::new(false);
        let found = setup.evaluator.measure(&chosen.specimen, search, &Plan::WINDOW, &never);
        found.map_err(Failure::input)
    });
    Some(match measured {
        Ok(evaluation) => ComputedToo::Measured(Box::new(evaluation)),
        Err(failure) => ComputedToo::Refused(failure.to_string()),
    })
}

impl ComputedToo {
    /// One line or two.
    pub fn text(&self) -> String {
        let said = match self {
            ComputedToo::Refused(why) => why.clone(),
            ComputedToo::Measured(evaluation) => match evaluation.window.nominal {
                Outcome::Inserted => format!(
                    "{:.1} mm ({:.1} to {:+.1})",
                    evaluation.window.range_mm(),
                    evaluation.window.negative_mm(),
                    evaluation.window.positive_mm()
                ),
                failed => format!("none: its nominal start ends with {}", failed.label()),
            },
        };
        format!("from its ribs {said}; --finger-model computed\n")
    }

    /// The key that `--json` adds.
    pub fn json(&self) -> Value {
        match self {
            ComputedToo::Measured(evaluation) => json!({ "computed": evaluation }),
            ComputedToo::Refused(why) => json!({ "computed": { "refused": why } }),
        }
    }
}
