//! The published ranges: simulation and bench, 11 designs, four tasks.

use crate::input::stiffness::{Measurement, SHIPPED_CSV, SHIPPED_FILE, parse};
use crate::outcome::FailureClass;
use serde::Deserialize;

const SIMULATION: &str = include_str!("../../data/published_simulation.csv");
const BENCH: &str = include_str!("../../data/published_bench.csv");

/// Where a published range comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The publication's MuJoCo simulation.
    Simulation,
    /// The publication's robot.
    Bench,
}

/// One published result.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Published {
    /// Name of the task.
    pub task: String,
    /// Number of the design, as in [`designs`].
    pub design: u32,
    /// What stopped the shift in the negative direction.
    pub failure_negative_offset: Option<FailureClass>,
    /// What stopped the shift in the positive direction.
    pub failure_positive_offset: Option<FailureClass>,
    /// Tolerable range, mm; `None` if the publication gives none.
    pub tolerable_range_mm: Option<f64>,
}

impl Published {
    /// Range and failure classes at both ends: `7.2 mm (3 | 3)`.
    pub fn words(&self) -> String {
        let class =
            |c: Option<FailureClass>| c.map_or("–".to_owned(), |c| c.number().to_string());
        let Some(range) = self.tolerable_range_mm else { return "not given".to_owned() };
        let ends = [class(self.failure_negative_offset), class(self.failure_positive_offset)];
        format!("{range:.1} mm ({} | {})", ends[0], ends[1])
    }
}

/// The published results of a task; empty for a task that is not among them.
pub fn of_task(task: &str, origin: Origin) -> Vec<Published> {
    let text = match origin {
        Origin::Simulation => SIMULATION,
        Origin::Bench => BENCH,
    };
    let rows = csv::Reader::from_reader(text.as_bytes()).into_deserialize::<Published>();
    rows.flatten().filter(|row| row.task == task).collect()
}

/// The designs the publication measured.
pub fn designs() -> Vec<Measurement> {
    parse(SHIPPED_CSV, SHIPPED_FILE).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_published_rows_are_read() {
        for task in ["ket8", "ket12", "rj45", "usb"] {
            assert_eq!(of_task(task, Origin::Simulation).len(), 11, "{task}");
            assert_eq!(of_task(task, Origin::Bench).len(), 11, "{task}");
        }
        assert!(of_task("mine", Origin::Bench).is_empty());
        assert_eq!(designs().len(), 11);
    }
}
