//! Whether every computed finger of a space has springs, asked before the first one is simulated.

use super::evaluator::Evaluator;
use super::template::{Impossible, is_infill};
use crate::finger::computed::AtPad;
use crate::finger::model::{FingerSource, RCC_KEY, TILTING_KEY};
use crate::space::{Design, Parameter, Space, corners};
use input::{Check, InputError};

/// A space read from `file` that sets a computed finger's remote centre or tilting stiffness may ask
/// for what no springs give: a centre so far away that turning about it alone is softer than measured.
/// The more so the farther and the softer, so the extreme values are tried, of the infill, too.
///
/// # Errors
/// The first combination that has no springs.
pub fn check(evaluator: &Evaluator, space: &Space, file: &str) -> Result<(), InputError> {
    let sets = |key: &str| [RCC_KEY, TILTING_KEY].contains(&key);
    let computed = matches!(evaluator.fingers, FingerSource::Computed(_));
    let Some(first) = space.parameters.iter().find(|p| computed && sets(&p.key)) else {
        return Ok(());
    };
    let tried = |p: &&Parameter| sets(&p.key) || is_infill(&p.key);
    for design in corners(space.parameters.iter().filter(tried), usize::MAX) {
        if let Err(error) = springs(evaluator, &design) {
            return Check { file }.fail(&first.key, format!("{design} has no springs: {error}"));
        }
    }
    Ok(())
}

fn springs(evaluator: &Evaluator, design: &Design) -> Result<(), Impossible> {
    let stiffness = evaluator.predict(design)?;
    let at_pad = AtPad::of(&stiffness);
    for template in &evaluator.templates {
        evaluator.fingers.make(at_pad, design, &template.task)?;
    }
    Ok(())
}
