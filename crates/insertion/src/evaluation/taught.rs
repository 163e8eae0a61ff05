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
use crate::trial::{Conditions, Grasped, Recording, Rig, Sample, Trial};
use std::ops::Deref;
use std::sync::atomic::AtomicBool;

/// Distance between the starts that are tried, in grid steps.
const STRIDE: OffsetStep = 5;
/// Farthest start that is tried, in grid steps: 10 mm.
const FARTHEST: OffsetStep = 100;

/// By how much the start is moved, in grid steps; `None` if none inserts. Ends early, with a
/// worthless result, once `stop` is set.
pub fn teach(rig: &dyn Rig, finger: &Finger, stop: &AtomicBool) -> Option<OffsetStep> {
    let rig: &dyn Rig = &Stoppable { rig, stop };
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

/// A rig whose start is moved.
pub struct Moved<R> {
    /// Where trials are run.
    pub rig: R,
    /// By how much, in grid steps.
    pub by: OffsetStep,
}

impl<R: Deref<Target: Rig> + Send + Sync> Rig for Moved<R> {
    fn grasp_until<'a>(
        &'a self,
        finger: &Finger,
        conditions: &Conditions,
        stop: &'a AtomicBool,
    ) -> Box<dyn Grasped + 'a> {
        let grasped = self.rig.grasp_until(finger, conditions, stop);
        Box::new(MovedGrasp { grasped, by: offset(self.by) })
    }

    fn record(&self, finger: &Finger, shift: f64) -> Option<Recording> {
        self.rig.record(finger, shift + offset(self.by))
    }
}

struct MovedGrasp<'a> {
    grasped: Box<dyn Grasped + 'a>,
    by: f64,
}

impl Grasped for MovedGrasp<'_> {
    fn trial(&self, offset: f64) -> Trial {
        self.grasped.trial(offset + self.by)
    }

    fn traced(&self, offset: f64, every_s: f64) -> (Trial, Vec<Sample>) {
        self.grasped.traced(offset + self.by, every_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::NEVER;
    use crate::trial::fake::FakeRig;
    use input::units::N_PER_MM;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn the_taught_start_is_the_middle_of_the_nearest_window() {
        // -(2 + 4/3) = -3.33 and 1 + 20/50 = 1.4 mm.
        let finger = Finger::new(3.0 * N_PER_MM, 20.0 * N_PER_MM);
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
    /// The closed-form rig, which sets the flag after so many trials and counts all.
    struct Interrupted {
        after: usize,
        stop: AtomicBool,
        trials: AtomicUsize,
    }

    struct InterruptedGrasp<'a>(&'a Interrupted, Box<dyn Grasped + 'a>);

    impl Rig for Interrupted {
        fn grasp_until<'a>(
            &'a self,
            finger: &Finger,
            conditions: &Conditions,
            stop: &'a AtomicBool,
        ) -> Box<dyn Grasped + 'a> {
            static RIG: FakeRig = FakeRig { delay: std::time::Duration::ZERO };
            Box::new(InterruptedGrasp(self, RIG.grasp_until(finger, conditions, stop)))
        }
    }

    impl Grasped for InterruptedGrasp<'_> {
        fn trial(&self, offset: f64) -> Trial {
            let trials = self.0.trials.fetch_add(1, Ordering::SeqCst) + 1;
            self.0.stop.fetch_or(trials >= self.0.after, Ordering::SeqCst);
            self.1.trial(offset)
        }
    }

    #[test]
    fn teaching_ends_when_it_is_to_stop() {
        let finger = Finger::new(3.0 * N_PER_MM, 20.0 * N_PER_MM);
        for after in [1, 2, 5] {
            let counter =
                Interrupted { after, stop: AtomicBool::new(false), trials: AtomicUsize::new(0) };
            let far = Moved { rig: &counter as &dyn Rig, by: 30 };
            teach(&far, &finger, &counter.stop);
            assert_eq!(counter.trials.load(Ordering::SeqCst), after);
        }
    }

    /// `stop` reaches the rig below, whose running trial it is to end.
    #[test]
    fn a_moved_rig_hands_the_flag_on() {
        struct Asked(AtomicBool);
        impl Rig for Asked {
            fn grasp_until<'a>(
                &'a self,
                finger: &Finger,
                conditions: &Conditions,
                stop: &'a AtomicBool,
            ) -> Box<dyn Grasped + 'a> {
                self.0.store(stop.load(Ordering::SeqCst), Ordering::SeqCst);
                static RIG: FakeRig = FakeRig { delay: std::time::Duration::ZERO };
                RIG.grasp_until(finger, conditions, stop)
            }
        }
        let (asked, stop) = (Asked(AtomicBool::new(false)), AtomicBool::new(true));
        let finger = Finger::new(3.0 * N_PER_MM, 20.0 * N_PER_MM);
        let moved = Moved { rig: &asked as &dyn Rig, by: 3 };
        drop(moved.grasp_until(&finger, &Conditions::NOMINAL, &stop));
        assert!(asked.0.load(Ordering::SeqCst));
    }
}
