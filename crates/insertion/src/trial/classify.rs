//! Classification of the outcome of a trial.
//!
//! 1. The part is seated (its tip in the opening, deep and upright enough) and held
//!    by both fingers at rest after the assembly push, or where the force limit ended
//!    it: inserted.
//! 2. The part left the grasp (both fingers off, or slipped beyond the task's
//!    limit) before the search began: class 1; later: class 4. So does a part that is
//!    seated, but that one finger has let go of: pushed aside by more than twice the
//!    grasp force, it stands where it is driven by the other finger alone.
//! 3. Its leading edge is not inside the opening when the search ends: class 2, "a failed search
//!    phase in which the plug is missed" (paper, Sec. "Failure Cases").
//! 4. Otherwise it entered and is not seated, whether fingers still touch it or not: class 3.

use crate::outcome::{FailureClass, Outcome};
use crate::task::{Stage, Task};
use contact::scene::Pose;
use nalgebra::Vector3;

#[derive(Debug, Clone, Copy)]
pub(super) struct Placement {
    /// Tip of the plug, task frame, m.
    pub tip: Vector3<f64>,
    /// Angle between its axis and z, rad.
    pub tilt: f64,
}

impl Placement {
    pub fn new(plug: &Pose) -> Self {
        let tilt = libm::acos((plug * Vector3::z()).z.clamp(-1.0, 1.0));
        Placement { tip: plug.translation.vector, tilt }
    }

    pub fn seated(&self, task: &Task) -> bool {
        let [x, y] = task.opening;
        // Deep beside the socket is not inserted.
        let inside = within(self.tip.x, x) && within(self.tip.y, y);
        inside && -self.tip.z >= task.success.depth && self.tilt <= task.success.tilt
    }

    /// Margin of this outcome; see [`super::Trial::margin`].
    pub fn margin(&self, task: &Task, outcome: Outcome) -> f64 {
        let success = task.success;
        let deep = (-self.tip.z - success.depth) / success.depth;
        let upright = (success.tilt - self.tilt) / success.tilt;
        let margin = deep.min(upright).clamp(-1.0, 1.0);
        match outcome {
            Outcome::Inserted => margin.max(0.0),
            // Lost before it came to the socket: nothing is nearer to success for being deeper.
            Outcome::Failed(FailureClass::ContactLossBeforeSearch) => -1.0,
            Outcome::Failed(_) => margin.min(0.0),
            Outcome::Diverged => 0.0,
        }
    }
}

pub(super) fn within(value: f64, [from, to]: [f64; 2]) -> bool {
    from <= value && value <= to
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Facts {
    pub seated: bool,
    /// Whether both fingers are in contact over the final window.
    pub gripped: bool,
    /// The stage in which the part left the grasp.
    pub lost_in: Option<Stage>,
    /// The leading edge was inside the opening when the search ended.
    pub entered: bool,
}

/// Returns the outcome of a trial that did not diverge.
pub fn classify(facts: Facts) -> Outcome {
    match facts {
        Facts { seated: true, gripped: true, .. } => Outcome::Inserted,
        Facts { seated: true, gripped: false, .. } => {
            Outcome::Failed(FailureClass::ContactLossInInsertion)
        }
        Facts { lost_in: Some(Stage::Approach), .. } => {
            Outcome::Failed(FailureClass::ContactLossBeforeSearch)
        }
        Facts { lost_in: Some(_), .. } => Outcome::Failed(FailureClass::ContactLossInInsertion),
        Facts { entered: false, .. } => Outcome::Failed(FailureClass::PlugMissed),
        Facts { entered: true, .. } => Outcome::Failed(FailureClass::Jammed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use FailureClass::*;

    #[test]
    fn every_rule_decides_in_its_order() {
        let facts = |seated, gripped, lost_in, entered| Facts { seated, gripped, lost_in, entered };
        for (given, class) in [
            (facts(true, false, None, true), ContactLossInInsertion),
            (facts(false, false, Some(Stage::Approach), false), ContactLossBeforeSearch),
            (facts(false, false, Some(Stage::Search), false), ContactLossInInsertion),
            (facts(false, false, Some(Stage::Assembly), true), ContactLossInInsertion),
            (facts(false, true, None, false), PlugMissed),
            // What jams is pushed aside, too: that it is let go of then is not the cause.
            (facts(false, false, None, true), Jammed),
        ] {
            assert_eq!(classify(given), Outcome::Failed(class), "{given:?}");
        }
        let held = facts(true, true, Some(Stage::Assembly), true);
        assert_eq!(classify(held), Outcome::Inserted);
    }
}
