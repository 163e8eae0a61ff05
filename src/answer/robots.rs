//! The finger that is named under another robot.

use super::words::{ends_mm, outcome, span};
use insertion::evaluation::{Evaluation, grid_mm};
use insertion::outcome::Outcome;
use serde::{Deserialize, Serialize};

/// What a finger tolerates under a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UnderRobot {
    /// Name of the robot.
    pub robot: String,
    /// What it gives along x, y and z, N/mm; `None` of one that does not give.
    pub stiffness_n_per_mm: Option<[f64; 3]>,
    /// What was measured with it.
    #[serde(flatten)]
    pub measured: Evaluation,
}

impl UnderRobot {
    /// Robot and window: `ur5e_position (39 N/mm along y): -2.1 to +3.0 mm`.
    pub fn words(&self) -> String {
        let gives = self
            .stiffness_n_per_mm
            .map_or("gives nothing".to_owned(), |[_, y, _]| format!("{y:.0} N/mm along y"));
        let window = match (self.measured.window.nominal, self.measured.taught) {
            (Outcome::Inserted, taught) => {
                let taught = taught
                    .map_or(String::new(), |by| format!(", start taught {:+.1} mm", grid_mm(by)));
                format!("{} mm{taught}", span(ends_mm(&self.measured.window)))
            }
            (nominal, _) => format!("none, its nominal start ends with {}", outcome(nominal)),
        };
        format!("{} ({gives}): {window}", self.robot)
    }
}
