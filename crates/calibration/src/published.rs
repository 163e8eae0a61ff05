//! The published ranges of 11 designs on four tasks, simulated and measured.

use crate::experiments::{self, Experiment};
use input::shipped::MEASUREMENTS;

/// Ranges by the MuJoCo simulation of the publication, as a measurement file.
pub const SIMULATION: &str = include_str!("../../../data/published_simulation.csv");
/// Ranges measured on the robot of the publication, as a measurement file.
pub const BENCH: &str = MEASUREMENTS[0].text;

/// Returns the lines of a task in [`SIMULATION`] or [`BENCH`]; none for an unpublished task.
pub fn of_task(task: &str, published: &str) -> Vec<Experiment> {
    let mut lines = experiments::parse(published, "").unwrap_or_default();
    lines.retain(|line| line.task == task);
    lines
}
