//! Shipped robots with the cells that they represent, and their stiffness at the TCP.

use super::files::robot;
use crate::failure::Failure;
use input::units::N_PER_MM;
use insertion::robot::{Flange, Robot};
use serde::{Deserialize, Serialize};

/// Shipped robot and the cell that it represents. `cells.toml` contains only the fields that the robot file lacks.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CellRobot {
    /// Description of the cell.
    pub cell: String,
    /// Name of the robot.
    pub name: String,
    /// Description of the robot.
    #[serde(default)]
    pub description: String,
    /// Stiffness at the TCP along x, y and z, upright, N/mm; `None` if rigid.
    pub stiffness_n_per_mm: Option<[f64; 3]>,
    /// Lag behind a command of constant speed, s.
    #[serde(default)]
    pub lag_s: f64,
    /// Contact force at which it stops, N.
    #[serde(default)]
    pub stop_force_n: f64,
    /// Source of its parameters; see the robot file for details.
    pub source: String,
}

/// Returns the shipped robots, that of the most common cell first.
///
/// # Errors
/// If a shipped file is damaged.
pub fn robots() -> Result<Vec<CellRobot>, Failure> {
    let mut cells: std::collections::BTreeMap<String, Vec<CellRobot>> =
        input::read(include_str!("cells.toml"), "cells.toml")?;
    let mut robots = cells.remove("robot").unwrap_or_default();
    for found in &mut robots {
        let robot = robot(&found.name)?;
        (found.stiffness_n_per_mm, found.lag_s) = stiffness_and_lag(&robot, [0.0; 2])?;
        (found.description, found.stop_force_n) = (robot.description, robot.stop_force);
    }
    Ok(robots)
}

/// Returns stiffness along x, y and z of the task, N/mm (`None` if rigid), and lag, s, of a robot; `turn` is the
/// rotation of the task frame about z of the base, and `tilt` that of the TCP about its x, rad.
pub(crate) fn stiffness_and_lag(
    robot: &Robot,
    [turn, tilt]: [f64; 2],
) -> Result<(Option<[f64; 3]>, f64), Failure> {
    let (stiffness, lag_s) = match robot.mount(turn, tilt).map_err(Failure::input)?.flange {
        Flange::Ideal => return Ok((None, 0.0)),
        // No lag at constant speed: the damper acts on the rate of the position error.
        Flange::Servo(servo) => (servo.stiffness, 0.0),
        Flange::Arm(arm) => {
            let lag_s = if arm.feed_forward { 0.0 } else { arm.time_constant };
            ([0, 1, 2].map(|i| 1.0 / arm.compliance[(i, i)]), lag_s)
        }
    };
    Ok((Some(stiffness.map(|k| k / N_PER_MM)), lag_s))
}
