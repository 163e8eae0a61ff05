//! Classification of the outcome of a trial.
//!
//! 1. The part is seated (its tip in the opening, deep and upright enough) and held
//!    by both fingers at rest after the assembly push: inserted. A protective stop of the
//!    robot during the push ends the trial; what it has seated by then counts alike.
//! 2. The part left the grasp (both fingers off, or slipped beyond the task's
//!    limit) before the search began: class 1; later: class 4. A seated
//!    part without contact to one finger is class 4, too: pushed aside by more than twice
//!    the grasp force, it is held by the other finger alone.
//! 3. The leading edge is not inside the opening when the search ends, or the part ends beside its
//!    mated pose: class 2, "a failed search phase in which the plug is missed" (paper, Sec. "Failure Cases").
//! 4. Otherwise the part entered and is not seated, whether fingers still touch it or not: class 3.

use crate::{FailureClass, Outcome, Stage, Task};
use contact::scene::Pose;
use nalgebra::Vector3;

/// Distance beyond the lateral tolerance of an inserted plug from which the plug has missed, m.
const ASTRAY_DISTANCE: f64 = 0.5e-3;

/// Position and tilt of the plug in the opening.
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

    /// Returns whether the plug is in the opening or at its mated position, deep and upright enough.
    pub fn seated(&self, task: &Task) -> bool {
        let [x, y] = task.opening;
        // A plug beside the socket can be deep without being inserted.
        let inside = match &task.success.mated {
            Some(mated) => mated.distance_to(&self.tip) <= mated.lateral,
            None => within(self.tip.x, x) && within(self.tip.y, y),
        };
        inside && -self.tip.z >= task.success.depth && self.tilt <= task.success.tilt
    }

    /// Returns whether the plug is beside its mated position, for example by one pitch of its pins.
    pub fn astray(&self, task: &Task) -> bool {
        let mated = task.success.mated.as_ref();
        mated.is_some_and(|mated| mated.distance_to(&self.tip) > mated.lateral + ASTRAY_DISTANCE)
    }

    /// Returns the margin of this outcome; see [`super::Trial::margin`].
    pub fn margin(&self, task: &Task, outcome: Outcome) -> f64 {
        let success = task.success;
        let deep = (-self.tip.z - success.depth) / success.depth;
        let upright = (success.tilt - self.tilt) / success.tilt;
        let margin = deep.min(upright).clamp(-1.0, 1.0);
        match outcome {
            Outcome::Inserted => margin.max(0.0),
            // The plug was lost before the socket: its depth does not measure the distance from success.
            Outcome::Failed(FailureClass::ContactLossBeforeSearch) => -1.0,
            Outcome::Failed(_) => margin.min(0.0),
            Outcome::Diverged => 0.0,
        }
    }
}

pub(super) fn within(value: f64, [from, to]: [f64; 2]) -> bool {
    from <= value && value <= to
}

/// State at the end of a trial that determines its outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FinalState {
    /// Whether the plug is inserted deep enough and upright, and at rest or stopped by the force limit.
    pub seated: bool,
    /// Whether both fingers are in contact over the final window.
    pub gripped: bool,
    /// Stage in which the part left the grasp, if it did.
    pub lost_in: Option<Stage>,
    /// Whether the leading edge was inside the opening when the search ended, and the plug is not beside its mated
    /// pose.
    pub entered: bool,
}

/// Returns the outcome of a trial that did not diverge.
pub fn classify(FinalState { seated, gripped, lost_in, entered }: FinalState) -> Outcome {
    if seated && gripped {
        return Outcome::Inserted;
    }
    Outcome::Failed(match lost_in {
        _ if seated => FailureClass::ContactLossInInsertion,
        Some(Stage::Approach) => FailureClass::ContactLossBeforeSearch,
        Some(_) => FailureClass::ContactLossInInsertion,
        None if entered => FailureClass::Jammed,
        None => FailureClass::PlugMissed,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::Mated;
    use crate::tests::fixtures::task;
    use FailureClass::*;

    /// 2 x 5 header: a pitch of 2.54 mm aside is deep and upright, and has missed.
    #[test]
    fn a_plug_beside_its_mated_pose_is_not_seated_and_has_missed() {
        let mut header = task("usb");
        let mated = Mated { tip: [0.2e-3, 0.0, -12.5e-3], lateral: 0.1e-3 };
        for (x_mm, seated, astray) in [
            (0.2, true, false),
            (0.29, true, false),
            (0.5, false, false),
            (0.2 + 2.54, false, true),
            (0.2 - 2.54, false, true),
        ] {
            let placement = Placement { tip: Vector3::new(x_mm * 1e-3, 0.0, -12.4e-3), tilt: 0.0 };
            header.success.mated = Some(mated);
            assert_eq!(placement.seated(&header), seated, "{x_mm}");
            assert_eq!(placement.astray(&header), astray, "{x_mm}");
            // Within the opening of 7.55 mm all are seated.
            header.success.mated = None;
            assert!(placement.seated(&header) && !placement.astray(&header), "{x_mm}");
        }
    }

    #[test]
    fn the_rules_apply_in_order() {
        let state =
            |seated, gripped, lost_in, entered| FinalState { seated, gripped, lost_in, entered };
        for (given, class) in [
            (state(true, false, None, true), ContactLossInInsertion),
            (state(false, false, Some(Stage::Approach), false), ContactLossBeforeSearch),
            (state(false, false, Some(Stage::Search), false), ContactLossInInsertion),
            (state(false, false, Some(Stage::Assembly), true), ContactLossInInsertion),
            (state(false, true, None, false), PlugMissed),
            // A jammed part is also pushed aside: its loss by the fingers is then not the cause.
            (state(false, false, None, true), Jammed),
        ] {
            assert_eq!(classify(given), Outcome::Failed(class), "{given:?}");
        }
        let held = state(true, true, Some(Stage::Assembly), true);
        assert_eq!(classify(held), Outcome::Inserted);
    }
}
