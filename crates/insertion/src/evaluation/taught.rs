//! A taught start: where a person would put it who moves the robot until the plug goes in.
//!
//! From the task's own start outward, in strides of 0.5 mm (+0.5, -0.5, +1 and so on), the first
//! that inserts is looked for; then the window around it; the start is its middle. If the
//! middle does not insert, since the window has a gap, the start stays where it was found.

use super::stoppable::Stoppable;
use super::tolerance::{self, OFFSET_LIMIT_STEPS, Search, offset};
use super::{OffsetStep, Window};
use crate::finger::Finger;
use crate::outcome::Outcome;
use crate::trial::{Grasp, Grasped, Recording, Rig, Sample, Trial};
use std::ops::Deref;
use std::sync::atomic::AtomicBool;

/// Distance between the starts that are tried, in grid steps.
const STRIDE: OffsetStep = 5;
/// Farthest start that is tried, in grid steps: 10 mm.
const FARTHEST: OffsetStep = 100;

/// By how much the start is moved, in grid steps; `None` if none inserts. Ends early, with a
/// worthless result, once `stop` is set.
pub fn teach(rig: &dyn Rig, finger: &Finger, stop: &AtomicBool) -> Option<OffsetStep> {
    let rig: &dyn Rig = &Stoppable { inner: rig, stop };
    let grasped = rig.grasp(finger);
    let inserts = |step| grasped.trial(offset(step)).outcome == Outcome::Inserted;
    let outward = (1..=FARTHEST / STRIDE).flat_map(|n| [n * STRIDE, -n * STRIDE]);
    let found = std::iter::once(0).chain(outward).find(|&step| inserts(step))?;
    let window = tolerance::evaluate(&Moved { rig, by: found }, finger, Search::Strides).window;
    let middle = found + middle(&window);
    Some(if inserts(middle) { middle } else { found })
}

/// The middle of a window, in grid steps, towards zero.
fn middle(window: &Window) -> OffsetStep {
    (window.negative_steps + window.positive_steps).clamp(-OFFSET_LIMIT_STEPS, OFFSET_LIMIT_STEPS)
        / 2
}

/// A rig, or a grasped part, whose start is moved.
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
    fn trial(&self, shift: f64) -> Trial {
        self.rig.trial(shift + offset(self.by))
    }

    fn traced(&self, shift: f64, every_s: f64) -> (Trial, Vec<Sample>) {
        self.rig.traced(shift + offset(self.by), every_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::finger;
    use crate::trial::fake::{Altered, FakeRig};
    use crate::trial::{Conditions, NEVER};
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn the_taught_start_is_the_middle_of_the_nearest_window() {
        // -(2 + 4/3) = -3.33 and 1 + 20/50 = 1.4 mm.
        let finger = finger(3.0, 20.0);
        let fake = FakeRig::default();
        for (away, taught) in [(0, -9), (30, -39), (-50, 41)] {
            let moved = Moved { rig: &fake as &dyn Rig, by: away };
            let found = teach(&moved, &finger, &NEVER).unwrap();
            assert!((found - taught).abs() <= 1, "{away}: {found}");
            let middled = Moved { rig: &moved as &dyn Rig, by: found };
            let window = tolerance::evaluate(&middled, &finger, Search::Walk).window;
            assert_eq!(window.range_mm(), 4.7);
            assert!((window.negative_steps + window.positive_steps).abs() <= 2, "{window:?}");
        }
        let far = Moved { rig: &fake as &dyn Rig, by: 200 };
        assert_eq!(teach(&far, &finger, &NEVER), None);
    }

    #[test]
    fn teaching_ends_when_it_is_to_stop() {
        let finger = finger(3.0, 20.0);
        for after in [1, 2, 5] {
            let (stop, trials) = (AtomicBool::new(false), AtomicUsize::new(0));
            let counted = Altered(|_: &Grasp, _: f64, trial: Trial| {
                let trials = trials.fetch_add(1, Ordering::SeqCst) + 1;
                stop.fetch_or(trials >= after, Ordering::SeqCst);
                trial
            });
            teach(&Moved { rig: &counted as &dyn Rig, by: 30 }, &finger, &stop);
            assert_eq!(trials.load(Ordering::SeqCst), after);
        }
    }

    /// `stop` reaches the rig below, whose running trial it is to end.
    #[test]
    fn a_moved_rig_hands_the_flag_on() {
        let asking = Altered(|grasp: &Grasp, _: f64, trial: Trial| {
            assert!(grasp.stop.load(Ordering::SeqCst));
            trial
        });
        let (finger, conditions) = (finger(3.0, 20.0), Conditions::NOMINAL);
        let moved = Moved { rig: &asking as &dyn Rig, by: 3 };
        moved.hold(Grasp { finger, conditions, stop: &AtomicBool::new(true) }).trial(0.0);
    }
}
