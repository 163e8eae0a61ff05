//! Window of the recommended finger on a robot other than that of the study, for comparison.

use super::lines;
use insertion::evaluation::{Evaluation, grid_mm};
use serde::{Deserialize, Serialize};

/// Tolerance window of a finger on a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobotWindow {
    /// Name of the robot.
    pub robot: String,
    /// Stiffness along x, y and z, N/mm; `None` for a rigid robot.
    pub stiffness_n_per_mm: Option<[f64; 3]>,
    /// Evaluation on this robot.
    #[serde(flatten)]
    pub measured: Evaluation,
}

impl RobotWindow {
    /// Returns the robot and the window in words: `ur5e_position (39 N/mm along y): -2.1 to +3.0 mm`.
    pub fn words(&self) -> String {
        let stiffness = self.stiffness_n_per_mm.map(|[_, y, _]| format!("{y:.0} N/mm along y"));
        let stiffness = stiffness.unwrap_or("rigid".to_owned());
        let (_, window) = &lines::window(&self.measured)[0];
        let taught =
            self.measured.taught.map(|by| format!(", start taught {:+.1} mm", grid_mm(by)));
        format!("{} ({stiffness}): {window}{}", self.robot, taught.unwrap_or_default())
    }
}
