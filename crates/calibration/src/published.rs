//! The published ranges: simulation and bench, 11 designs, four tasks.

use crate::experiments::{self, Experiment};
use input::shipped::MEASUREMENTS;

/// Ranges by the publication's MuJoCo simulation.
pub const SIMULATION: &str = include_str!("../../../data/published_simulation.csv");
/// Ranges on the publication's robot.
pub const BENCH: &str = MEASUREMENTS[0].text;

/// Returns the results of a task in one of the published tables; empty for an unpublished task.
pub fn of_task(task: &str, published: &str) -> Vec<Experiment> {
    let mut lines = experiments::parse(published, "").unwrap_or_default();
    lines.retain(|line| line.task == task);
    lines
}
