//! What a finger keeps of its window when not everything is as the task file
//! says: trials and windows under drawn errors.

pub mod firm;
mod range;
pub mod repeat;
mod success;

use crate::evaluation::Evaluation;
use crate::evaluation::tolerance::{self, Search};
use crate::evaluation::uncertainty::{Draw, RobustSettings, SuccessSettings, Uncertainty, draws};
use crate::finger::Finger;
use crate::surrogate::Prediction;
use crate::trial::Rig;

/// What is measured of a design beside its window, with the draws that all
/// designs of a study share.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plan {
    success: Option<(Vec<Draw>, SuccessSettings)>,
    robust: Option<(Vec<Draw>, RobustSettings)>,
}

impl Plan {
    /// Nothing beside the window.
    pub const WINDOW: Plan = Plan { success: None, robust: None };

    /// Success rates, robust ranges or both under the errors of a distribution;
    /// `seed` names the streams they are drawn from.
    pub fn new(uncertainty: &Uncertainty, seed: u64, success: bool, robust: bool) -> Self {
        let draws = |count| draws(&uncertainty.errors, seed, count);
        let (rate, range) = (uncertainty.success, uncertainty.robust);
        Plan {
            success: success.then(|| (draws(rate.trials), rate)),
            robust: robust.then(|| (draws(range.samples), range)),
        }
    }
}

/// Measures one finger, whose stiffness was predicted with an error: its window,
/// and what the plan adds.
pub fn evaluate(
    rig: &dyn Rig,
    finger: &Finger,
    predicted: &Prediction,
    search: Search,
    plan: &Plan,
) -> Evaluation {
    let mut evaluation = tolerance::evaluate(rig, finger, search);
    let part = |draw: &Draw| (draw.finger(finger, predicted), *draw);
    if let Some((draws, settings)) = &plan.success {
        let drawn: Vec<_> = draws.iter().map(part).collect();
        evaluation.success = Some(success::measure(rig, &drawn, settings));
    }
    if let Some((draws, settings)) = &plan.robust {
        let drawn: Vec<_> = draws.iter().map(part).collect();
        evaluation.robust = Some(range::measure(rig, &drawn, settings));
    }
    evaluation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{finger, predicted};
    use input::shipped::UNCERTAINTIES;

    /// Fingers of 3 N/mm and this assembly stiffness (N/mm) drawn under the shipped errors.
    pub fn drawn(assembly: f64, count: u32) -> (Uncertainty, Vec<(Finger, Draw)>) {
        let typical = Uncertainty::parse(UNCERTAINTIES[0].text, "typical").unwrap();
        let predicted = predicted([3.0, 1.0], [assembly, 2.0]);
        let nominal = finger(3.0, assembly);
        let drawn = draws(&typical.errors, 5, count).into_iter();
        let drawn = drawn.map(|draw| (draw.finger(&nominal, &predicted), draw)).collect();
        (typical, drawn)
    }
}
