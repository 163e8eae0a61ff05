//! The shipped robots, the cells that they stand for, and what a plug feels of them.

use super::files::robot;
use crate::failure::Failure;
use input::units::N_PER_MM;
use insertion::robot::{Flange, Robot};
use serde::{Deserialize, Serialize};

/// A shipped robot and the cell that it stands for; in the file only what the robot's own does not say.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ForCell {
    /// The cell, in words of whoever has it.
    pub cell: String,
    /// Name of the robot.
    pub name: String,
    /// Its description.
    #[serde(default)]
    pub description: String,
    /// Stiffness at the TCP along x, y and z, upright, N/mm; `None` of a rigid robot.
    pub stiffness_n_per_mm: Option<[f64; 3]>,
    /// By how much it trails a command of constant speed, s.
    #[serde(default)]
    pub lag_s: f64,
    /// Contact force at which it stops, N.
    #[serde(default)]
    pub stop_force_n: f64,
    /// Where its numbers come from; its own file says it in full.
    pub source: String,
}

/// The shipped robots, that of the likeliest cell first.
///
/// # Errors
/// If a shipped file is damaged.
pub fn robots() -> Result<Vec<ForCell>, Failure> {
    let mut cells: std::collections::BTreeMap<String, Vec<ForCell>> =
        input::read(include_str!("cells.toml"), "cells.toml").map_err(Failure::input)?;
    let mut robots = cells.remove("robot").unwrap_or_default();
    for found in &mut robots {
        let robot = robot(&found.name)?;
        (found.stiffness_n_per_mm, found.lag_s) = felt(&robot, [0.0; 2])?;
        (found.description, found.stop_force_n) = (robot.description, robot.stop_force);
    }
    Ok(robots)
}

/// Stiffness along x, y and z, N/mm, if it gives, and lag, s, of a robot at a task whose frame is turned
/// about the base's z, the TCP tilted about its x, rad.
pub(crate) fn felt(
    robot: &Robot,
    [turn, tilt]: [f64; 2],
) -> Result<(Option<[f64; 3]>, f64), Failure> {
    let (stiffness, lag_s) = match robot.mount(turn, tilt).map_err(Failure::input)?.flange {
        Flange::Ideal => return Ok((None, 0.0)),
        // Its damper acts on the rate of the error.
        Flange::Servo(servo) => (servo.stiffness, 0.0),
        Flange::Arm(arm) => {
            let lag_s = if arm.feed_forward { 0.0 } else { arm.time_constant };
            ([0, 1, 2].map(|i| 1.0 / arm.compliance[(i, i)]), lag_s)
        }
    };
    Ok((Some(stiffness.map(|k| k / N_PER_MM)), lag_s))
}
