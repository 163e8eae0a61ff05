//! The published ranges: simulation and bench, 11 designs, four tasks.

use crate::experiments::{self, Experiment};
use input::shipped::MEASUREMENTS;

const SIMULATION: &str = include_str!("../../../data/published_simulation.csv");

/// Source of a published range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The publication's MuJoCo simulation.
    Simulation,
    /// The publication's robot.
    Bench,
}

/// Returns the published results of a task; empty for an unpublished task.
pub fn of_task(task: &str, origin: Origin) -> Vec<Experiment> {
    let text = match origin {
        Origin::Simulation => SIMULATION,
        Origin::Bench => MEASUREMENTS[0].text,
    };
    let mut lines = experiments::parse(text, "").unwrap_or_default();
    lines.retain(|line| line.task == task);
    lines
}
