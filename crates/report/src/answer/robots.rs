//! Tolerance of the recommended finger with another robot.

use super::lines;
use insertion::evaluation::{Evaluation, grid_mm};
use serde::{Deserialize, Serialize};

/// Tolerance of a finger with one robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UnderRobot {
    /// Name of the robot.
    pub robot: String,
    /// Stiffness at the TCP along x, y and z, N/mm; `None` for a rigid robot.
    pub stiffness_n_per_mm: Option<[f64; 3]>,
    /// Evaluation of the finger with it.
    #[serde(flatten)]
    pub measured: Evaluation,
}

impl UnderRobot {
    /// Formats robot and window: `ur5e_position (39 N/mm along y): -2.1 to +3.0 mm`.
    pub fn words(&self) -> String {
        let gives = self.stiffness_n_per_mm.map(|[_, y, _]| format!("{y:.0} N/mm along y"));
        let gives = gives.unwrap_or("gives nothing".to_owned());
        let (_, window) = &lines::window(&self.measured)[0];
        let taught =
            self.measured.taught.map(|by| format!(", start taught {:+.1} mm", grid_mm(by)));
        format!("{} ({gives}): {window}{}", self.robot, taught.unwrap_or_default())
    }
}
