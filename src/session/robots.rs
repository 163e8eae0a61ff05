//! The shipped robots, the cells that they stand for, and what a plug feels of them.

use super::Failure;
use super::files::robot;
use input::shipped::ROBOTS;
use input::units::N_PER_MM;
use insertion::robot::{Flange, Robot};

/// A robot, and the cell that it stands for.
#[derive(Debug, Clone)]
pub struct ForCell {
    /// The cell, in words of whoever has it.
    pub cell: &'static str,
    /// The robot.
    pub robot: Robot,
    /// What it feels like.
    pub felt: Felt,
    /// Where its numbers come from; its file says it in full.
    pub source: &'static str,
}

/// What is felt of a robot at the start of a task whose frame is its base's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Felt {
    /// Force at the TCP over what it gives along x, y and z, N/mm; `None` of one that does not give.
    pub stiffness_n_per_mm: Option<[f64; 3]>,
    /// By how much it trails a command of constant speed, s.
    pub lag_s: f64,
}

/// Robot, cell and source, the likeliest cell first.
const CELLS: [(&str, &str, &str); 4] = [
    (
        "ur5e_position",
        "arm under position control, as a UR5e comes",
        "gears from Harmonic Drive's data, their sizes guessed; lag from the controller's manual; no arm \
         was measured",
    ),
    (
        "servo",
        "compliant wrist, or an arm under impedance or force control",
        "chosen between `rigid` and `ur5e`: put in your own stiffness",
    ),
    (
        "ur5e",
        "arm whose joints are soft springs, as in the publication's simulation",
        "joint gains of the publication, arm of the MuJoCo Menagerie",
    ),
    (
        "rigid",
        "axes that give far less than the finger: gantry, SCARA, press",
        "ideal; the stop force is the highest of a collaborative arm",
    ),
];

/// The shipped robots; one without a cell comes last, with none.
///
/// # Errors
/// If a shipped file is damaged.
pub fn robots() -> Result<Vec<ForCell>, Failure> {
    let one = |(name, cell, source): (&str, _, _)| {
        let robot = robot(name)?;
        Ok(ForCell { cell, felt: Felt::of(&robot, [0.0; 2])?, robot, source })
    };
    let others = ROBOTS.iter().filter(|file| CELLS.iter().all(|(name, ..)| *name != file.name));
    CELLS.into_iter().chain(others.map(|file| (file.name, "", ""))).map(one).collect()
}

impl Felt {
    /// Of a robot at a task whose frame is turned about the base's z, the TCP tilted about its x, rad.
    ///
    /// # Errors
    /// If an arm does not reach the start.
    pub fn of(robot: &Robot, [turn, tilt]: [f64; 2]) -> Result<Self, Failure> {
        let mount = |error| Failure::usage(format!("robot `{}`: {error}", robot.name));
        let in_n_per_mm = |stiffness: [f64; 3]| Some(stiffness.map(|k| k / N_PER_MM));
        Ok(match robot.mount(turn, tilt).map_err(mount)?.flange {
            Flange::Ideal => Felt { stiffness_n_per_mm: None, lag_s: 0.0 },
            // Its damper acts on the rate of the error.
            Flange::Servo(servo) => {
                Felt { stiffness_n_per_mm: in_n_per_mm(servo.stiffness), lag_s: 0.0 }
            }
            Flange::Arm(arm) => Felt {
                stiffness_n_per_mm: in_n_per_mm([0, 1, 2].map(|i| 1.0 / arm.compliance[(i, i)])),
                lag_s: if arm.feed_forward { 0.0 } else { arm.time_constant },
            },
        })
    }

    /// The name of a shipped robot that is as different: of a compliant one the position-controlled
    /// arm, of others the compliant flange.
    pub(super) fn contrast(&self) -> &'static str {
        match self.stiffness_n_per_mm {
            Some([_, y, _]) if y < COMPLIANT_N_PER_MM => "ur5e_position",
            _ => "servo",
        }
    }
}

/// Stiffness along y below which a robot counts as compliant: between that of `servo` and the 40 N/mm
/// of `ur5e_position`.
const COMPLIANT_N_PER_MM: f64 = 20.0;
