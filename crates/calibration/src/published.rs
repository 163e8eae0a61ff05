//! The published measured ranges of 11 designs on four tasks.

use crate::experiments::{self, Experiment};
use input::shipped::MEASUREMENTS;

/// Ranges measured on the robot of the publication, as a measurement file.
pub const BENCH: &str = MEASUREMENTS[0].text;

/// Returns the lines of a task in a published table; none for an unpublished task.
pub fn of_task(task: &str, published: &str) -> Vec<Experiment> {
    let mut lines = experiments::parse(published, "").unwrap_or_default();
    lines.retain(|line| line.task == task);
    lines
}
