//! Taught start: the start that an operator finds by moving the robot until the plug goes in.
//!
//! The search goes outward from the start in the task file in strides of 0.5 mm (+0.5, -0.5, +1 and so on) until a
//! start inserts, then determines the window around it; the taught start is the middle of the window. If the middle
//! does not insert, because the window has a gap, the first start that inserts is used.

use super::tolerance::{self, OFFSET_LIMIT_STEPS, Search, offset};
use super::{Evaluation, OffsetStep};
use crate::trial::{Followed, Grasped};
use crate::{Finger, Grasp, Outcome, Recording, Rig, Trial};
use std::ops::Deref;
use std::sync::atomic::AtomicBool;

/// Distance between the starts that are tried, in grid steps.
const STRIDE: OffsetStep = 5;
/// Farthest start that is tried, in grid steps: 10 mm.
const MAX_SHIFT: OffsetStep = 100;

/// A taught start.
#[derive(Debug, Clone, PartialEq)]
pub struct TaughtStart {
    /// Shift of the start, in grid steps.
    pub shift: OffsetStep,
    /// Search for the window around the first start that inserts; the window is relative to the taught start.
    pub evaluation: Evaluation,
}

/// Failing start with the largest margin, if no start inserts.
#[derive(Debug, Clone, PartialEq)]
pub struct Miss {
    /// Shift of the start, in grid steps.
    pub shift: OffsetStep,
    /// Trial from this start.
    pub trial: Trial,
}

/// Searches for the taught start. The result is invalid once `stop` is set.
///
/// # Errors
/// If no start inserts.
pub fn teach(rig: &dyn Rig, finger: &Finger, stop: &AtomicBool) -> Result<TaughtStart, Box<Miss>> {
    let grasp = Grasp { stop, ..Grasp::of(finger) };
    let grasped = rig.grasp(grasp);
    let shift = first_inserting(&*grasped)?;
    let moved = Shifted { rig, shift };
    let mut evaluation = tolerance::evaluate_grasp(&moved, grasp, Search::Strides);
    let window = &mut evaluation.window;
    let sum = window.negative_steps + window.positive_steps;
    // The division rounds towards zero.
    let middle = sum.clamp(-OFFSET_LIMIT_STEPS, OFFSET_LIMIT_STEPS) / 2;
    let inserts = grasped.trial(offset(shift + middle)).outcome == Outcome::Inserted;
    let middle = if inserts { middle } else { 0 };
    window.negative_steps -= middle;
    window.positive_steps -= middle;
    Ok(TaughtStart { shift: shift + middle, evaluation })
}

/// Returns the first start that inserts, searching outward from the start in the task file.
fn first_inserting(grasped: &dyn Grasped) -> Result<OffsetStep, Box<Miss>> {
    let outward = (1..=MAX_SHIFT / STRIDE).flat_map(|n| [n * STRIDE, -n * STRIDE]);
    let mut nearest = Miss { shift: 0, trial: grasped.trial(0.0) };
    if nearest.trial.outcome == Outcome::Inserted {
        return Ok(0);
    }
    for shift in outward {
        let trial = grasped.trial(offset(shift));
        if trial.outcome == Outcome::Inserted {
            return Ok(shift);
        }
        if trial.margin > nearest.trial.margin {
            nearest = Miss { shift, trial };
        }
    }
    Err(Box::new(nearest))
}

/// Rig or grasped part with a shifted start.
pub struct Shifted<R> {
    /// Rig or grasped part.
    pub rig: R,
    /// Shift of the start, in grid steps.
    pub shift: OffsetStep,
}

impl<R: Deref<Target: Rig> + Send + Sync> Rig for Shifted<R> {
    fn grasp<'a>(&'a self, grasp: Grasp<'a>) -> Box<dyn Grasped + 'a> {
        Box::new(Shifted { rig: self.rig.grasp(grasp), shift: self.shift })
    }

    fn record(&self, grasp: Grasp<'_>, shift: f64) -> Option<Recording> {
        self.rig.record(grasp, shift + offset(self.shift))
    }
}

impl Grasped for Shifted<Box<dyn Grasped + '_>> {
    fn run(&self, shift: f64, every_s: Option<f64>, rest_s: f64) -> Followed {
        self.rig.run(shift + offset(self.shift), every_s, rest_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fake::FakeRig;
    use crate::tests::fixtures::finger;
    use crate::trial::NEVER;

    #[test]
    fn the_taught_start_is_the_middle_of_the_nearest_window() {
        // -(2 + 4/3) = -3.33 and 1 + 20/50 = 1.4 mm.
        let finger = finger(3.0, 20.0);
        let fake = FakeRig::default();
        for (away, taught) in [(0, -9), (30, -39), (-50, 41)] {
            let moved = Shifted { rig: &fake as &dyn Rig, shift: away };
            let TaughtStart { shift: found, evaluation } = teach(&moved, &finger, &NEVER).unwrap();
            assert!((found - taught).abs() <= 1, "{away}: {found}");
            let centred = Shifted { rig: &moved as &dyn Rig, shift: found };
            let window = tolerance::evaluate(&centred, &finger, Search::Walk).window;
            assert_eq!(window.range_mm(), 4.7);
            assert_eq!(evaluation.window, window);
            assert!((window.negative_steps + window.positive_steps).abs() <= 2, "{window:?}");
        }
        let far = Shifted { rig: &fake as &dyn Rig, shift: 200 };
        let nearest = teach(&far, &finger, &NEVER).unwrap_err();
        assert!(nearest.trial.margin < 0.0 && nearest.shift.abs() <= MAX_SHIFT, "{nearest:?}");
    }
}
