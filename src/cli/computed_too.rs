//! The window of a finger as computed from its ribs, beside that of the default model: on which
//! of the two the bench agrees depends on the task (`docs/notes/finger.md`).

use super::Failure;
use super::setup::{Setup, SetupArguments};
use super::specimen::FingerArguments;
use crate::study::ByRibs;
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::tolerance::Search;
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// Measures the finger once more, from its ribs, with the start taught where the task's own does not
/// insert; nothing if a finger model was asked for, if the finger is given by its springs, or if the
/// engine has no such fingers.
pub fn measure(
    (arguments, setup): (&SetupArguments, &Setup),
    finger: &FingerArguments,
    search: Search,
    stop: &AtomicBool,
) -> Option<ByRibs> {
    if arguments.finger_model.kind.is_some() || finger.springs_are_given() {
        return None;
    }
    let evaluator = setup.by_ribs()?;
    let measured = finger.specimen(setup, &evaluator).and_then(|specimen| {
        let found = evaluator.measure_or_teach(&specimen, search, &Plan::WINDOW, stop);
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
