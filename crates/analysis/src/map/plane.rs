//! Trials over the plane of two errors of the start.

use super::trace::Node;
use super::{LIMIT, value};
use clap::ValueEnum;
use input::units::{DEG, MM};
use insertion::outcome::Outcome;
use insertion::trial::{Conditions, Grasp, Grasped, Rig};
use std::sync::OnceLock;

/// The two errors of a map: a shift of the start along y, and another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Axes {
    /// Shifts of the start along y and x
    #[default]
    #[value(name = "y,x")]
    YX,
    /// A shift along y, and a turn of the socket about z
    #[value(name = "y,yaw")]
    YYaw,
    /// A shift along y, and a turn of the part about x beside the tilt of the search
    #[value(name = "y,tilt")]
    YTilt,
}

impl Axes {
    /// Name and unit of both.
    pub(super) fn names(self) -> [[&'static str; 2]; 2] {
        let other = match self {
            Axes::YX => ["x", "mm"],
            Axes::YYaw => ["yaw", "deg"],
            Axes::YTilt => ["tilt", "deg"],
        };
        [["y", "mm"], other]
    }

    /// Conditions of a trial with this value of the second error, mm or degrees.
    fn conditions(self, value: f64) -> Conditions {
        let mut conditions = Conditions::NOMINAL;
        match self {
            Axes::YX => conditions.start_across = value * MM,
            Axes::YYaw => conditions.yaw = value * DEG,
            Axes::YTilt => conditions.start_tilt = value * DEG,
        }
        conditions
    }
}

/// A finger on its task under the two errors: the part is grasped once for each value of the second.
pub struct Plane<'a> {
    rig: &'a dyn Rig,
    grasp: Grasp<'a>,
    pub(super) axes: Axes,
    /// From the lowest value of the second error up.
    grasped: Vec<OnceLock<Box<dyn Grasped + 'a>>>,
}

impl<'a> Plane<'a> {
    /// Of this grasp; its conditions are replaced.
    pub fn new(rig: &'a dyn Rig, grasp: Grasp<'a>, axes: Axes) -> Self {
        let grasped = (-LIMIT[1]..=LIMIT[1]).map(|_| OnceLock::new()).collect();
        Plane { rig, grasp, axes, grasped }
    }

    /// How the trial of these errors ends.
    pub(super) fn outcome(&self, [y, other]: Node) -> Outcome {
        let hold = || {
            let conditions = self.axes.conditions(value(other));
            self.rig.hold(Grasp { conditions, ..self.grasp })
        };
        let inserts = |grasped: &dyn Grasped| grasped.trial(value(y) * MM).outcome;
        let place = usize::try_from(other + LIMIT[1]).ok().and_then(|at| self.grasped.get(at));
        match place {
            Some(place) => inserts(&**place.get_or_init(hold)),
            None => inserts(&*hold()),
        }
    }
}
