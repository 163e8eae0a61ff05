//! Trials of a finger under a shift of the start along y and a second error.

use clap::ValueEnum;
use input::units::MM;
use insertion::evaluation::uncertainty::Draw;
use insertion::trial::Grasped;
use insertion::{Grasp, Outcome, Rig};
use parameters::numbers::{SOCKET_YAW, START_ACROSS, START_TILT};
use parameters::plan::grid::{Node, STEPS_PER_UNIT};
use std::sync::OnceLock;

/// Largest errors of a map in either direction, in grid steps: 16 mm along y, and 8 mm or degrees.
pub(super) const LIMIT: Node = [16 * STEPS_PER_UNIT, 8 * STEPS_PER_UNIT];

/// Pair of errors of a map: a shift of the start along y, and a second error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Axes {
    /// Shifts of the start along y and x
    #[default]
    #[value(name = "y,x")]
    YX,
    /// A shift along y, and a turn of the socket about z
    #[value(name = "y,yaw")]
    YYaw,
    /// A shift along y, and a turn of the part about x in addition to the tilt of the search
    #[value(name = "y,tilt")]
    YTilt,
}

impl Axes {
    /// Returns the name and unit of the second error, and the path of the parameter that sets it.
    pub(super) fn second(self) -> ([&'static str; 2], &'static str) {
        match self {
            Axes::YX => (["x", "mm"], START_ACROSS),
            Axes::YYaw => (["yaw", "deg"], SOCKET_YAW),
            Axes::YTilt => (["tilt", "deg"], START_TILT),
        }
    }
}

/// Plane of the two errors of a map, at whose points trials are simulated. The part is grasped once for each value of
/// the second error.
pub struct Plane<'a> {
    rig: &'a dyn Rig,
    grasp: Grasp<'a>,
    pub(super) axes: Axes,
    /// Grasps by the value of the second error, ascending.
    grasped: Vec<OnceLock<Box<dyn Grasped + 'a>>>,
}

impl<'a> Plane<'a> {
    /// Creates the plane for a grasp; its conditions are replaced by those with the second error.
    pub fn new(rig: &'a dyn Rig, grasp: Grasp<'a>, axes: Axes) -> Self {
        let grasped = (-LIMIT[1]..=LIMIT[1]).map(|_| OnceLock::new()).collect();
        Plane { rig, grasp, axes, grasped }
    }

    /// Returns the outcome of the trial with these errors, which are within [`LIMIT`].
    pub(super) fn outcome(&self, [y, other]: Node) -> Outcome {
        let grasp = || {
            let conditions = Draw::with([(self.axes.second().1, value(other))]).conditions;
            self.rig.grasp(Grasp { conditions, ..self.grasp })
        };
        self.grasped[(other + LIMIT[1]) as usize].get_or_init(grasp).trial(value(y) * MM).outcome
    }
}

/// Converts a grid coordinate to the unit of its axis.
pub(super) fn value(node: i32) -> f64 {
    f64::from(node) / f64::from(STEPS_PER_UNIT)
}
