//! Taught start: the start that an operator finds by moving the robot until the plug goes in.
//!
//! The first start that inserts is searched outward from the task's own in strides of 0.5 mm (+0.5, -0.5,
//! +1 and so on), then the window about it; the taught start is the middle of the window. If the
//! middle does not insert, because the window has a gap, the first start is used.

use super::tolerance::{self, OFFSET_LIMIT_STEPS, Search, offset};
use super::{Evaluation, OffsetStep, Window};
use crate::finger::Finger;
use crate::outcome::Outcome;
use crate::trial::{Grasp, Grasped, Recording, Rig, Sample, Trial};
use std::ops::Deref;
use std::sync::atomic::AtomicBool;

/// Distance between the starts that are tried, in grid steps.
const STRIDE: OffsetStep = 5;
/// Farthest start that is tried, in grid steps: 10 mm.
const FARTHEST: OffsetStep = 100;

/// A taught start.
#[derive(Debug, Clone, PartialEq)]
pub struct Taught {
    /// Shift of the start, in grid steps.
    pub by: OffsetStep,
    /// Tolerance window around it.
    pub window: Window,
    /// Largest contact force over the inserted trials of the window search, N.
    pub peak_force_n: f64,
}

/// Failing start with the largest margin, if no start inserts.
#[derive(Debug, Clone, PartialEq)]
pub struct Nearest {
    /// Shift of the start, in grid steps.
    pub by: OffsetStep,
    /// Trial from this start.
    pub trial: Trial,
}

/// Searches the taught start. The result is invalid once `stop` is set.
///
/// # Errors
/// If no start inserts.
pub fn teach(rig: &dyn Rig, finger: &Finger, stop: &AtomicBool) -> Result<Taught, Box<Nearest>> {
    let grasp = Grasp { stop, ..Grasp::of(finger) };
    let grasped = rig.hold(grasp);
    let found = first_inserting(&*grasped)?;
    let moved = Moved { rig, by: found };
    let Evaluation { mut window, peak_force_n, .. } =
        tolerance::evaluate_in(&moved, grasp, Search::Strides);
    let both = window.negative_steps + window.positive_steps;
    // The division rounds towards zero.
    let middle = both.clamp(-OFFSET_LIMIT_STEPS, OFFSET_LIMIT_STEPS) / 2;
    let by = found + middle;
    if grasped.trial(offset(by)).outcome != Outcome::Inserted {
        return Ok(Taught { by: found, window, peak_force_n });
    }
    window.negative_steps -= middle;
    window.positive_steps -= middle;
    Ok(Taught { by, window, peak_force_n })
}

/// Returns the first start that inserts, outward from the task's own.
fn first_inserting(grasped: &dyn Grasped) -> Result<OffsetStep, Box<Nearest>> {
    let outward = (1..=FARTHEST / STRIDE).flat_map(|n| [n * STRIDE, -n * STRIDE]);
    let mut nearest = Nearest { by: 0, trial: grasped.trial(0.0) };
    if nearest.trial.outcome == Outcome::Inserted {
        return Ok(0);
    }
    for by in outward {
        let trial = grasped.trial(offset(by));
        if trial.outcome == Outcome::Inserted {
            return Ok(by);
        }
        if trial.margin > nearest.trial.margin {
            nearest = Nearest { by, trial };
        }
    }
    Err(Box::new(nearest))
}

/// Rig or grasped part with a shifted start.
pub struct Moved<R> {
    /// Rig or grasped part.
    pub rig: R,
    /// Shift of the start, in grid steps.
    pub by: OffsetStep,
}

impl<R: Deref<Target: Rig> + Send + Sync> Rig for Moved<R> {
    fn hold<'a>(&'a self, grasp: Grasp<'a>) -> Box<dyn Grasped + 'a> {
        Box::new(Moved { rig: self.rig.hold(grasp), by: self.by })
    }

    fn record(&self, grasp: Grasp<'_>, shift: f64) -> Option<Recording> {
        self.rig.record(grasp, shift + offset(self.by))
    }
}

impl Grasped for Moved<Box<dyn Grasped + '_>> {
    fn run(&self, shift: f64, every_s: Option<f64>, rest_s: f64) -> (Trial, Vec<Sample>) {
        self.rig.run(shift + offset(self.by), every_s, rest_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::finger;
    use crate::trial::NEVER;
    use crate::trial::fake::FakeRig;

    #[test]
    fn the_taught_start_is_the_middle_of_the_nearest_window() {
        // -(2 + 4/3) = -3.33 and 1 + 20/50 = 1.4 mm.
        let finger = finger(3.0, 20.0);
        let fake = FakeRig::default();
        for (away, taught) in [(0, -9), (30, -39), (-50, 41)] {
            let moved = Moved { rig: &fake as &dyn Rig, by: away };
            let Taught { by: found, window: said, .. } = teach(&moved, &finger, &NEVER).unwrap();
            assert!((found - taught).abs() <= 1, "{away}: {found}");
            let middled = Moved { rig: &moved as &dyn Rig, by: found };
            let window = tolerance::evaluate(&middled, &finger, Search::Walk).window;
            assert_eq!(window.range_mm(), 4.7);
            assert_eq!(said, window);
            assert!((window.negative_steps + window.positive_steps).abs() <= 2, "{window:?}");
        }
        let far = Moved { rig: &fake as &dyn Rig, by: 200 };
        let nearest = teach(&far, &finger, &NEVER).unwrap_err();
        assert!(nearest.trial.margin < 0.0 && nearest.by.abs() <= FARTHEST, "{nearest:?}");
    }
}
