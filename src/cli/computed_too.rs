//! The window of a finger as computed from its ribs, beside that of the default model: on which
//! of the two the bench agrees depends on the task (`docs/finger.md`).

use super::Failure;
use super::setup::{Setup, SetupArguments};
use super::specimen::FingerArguments;
use crate::evaluation::robustness::Plan;
use crate::evaluation::tolerance::Search;
use crate::finger::model::FingerModelKind;
use crate::study::ByRibs;
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// Measures the finger once more, from its ribs, with the start taught where the task's own does not
/// insert; nothing if a finger model was asked for, if the finger is given by its springs, or if the
/// engine has no such fingers.
pub fn measure(
    arguments: &SetupArguments,
    finger: &FingerArguments,
    search: Search,
) -> Option<ByRibs> {
    if arguments.finger_model.kind.is_some() || finger.springs_are_given() {
        return None;
    }
    let mut arguments = arguments.clone();
    arguments.finger_model.kind = Some(FingerModelKind::Computed);
    let setup = Setup::from_arguments(&arguments).ok()?;
    let measured = finger.choose(&setup).and_then(|chosen| {
        let never = AtomicBool::new(false);
        let found =
            setup.evaluator.measure_or_teach(&chosen.specimen, search, &Plan::WINDOW, &never);
        found.map_err(Failure::input)
    });
    Some(match measured {
        Ok(evaluation) => ByRibs::Measured(vec![evaluation]),
        Err(failure) => ByRibs::Refused(failure.to_string()),
    })
}

/// The key that `--json` adds.
pub fn json(found: &ByRibs) -> Value {
    match found {
        ByRibs::Measured(tasks) => json!({ "computed": tasks.first() }),
        ByRibs::Refused(why) => json!({ "computed": { "refused": why } }),
    }
}
