//! The published ranges: simulation and bench, 11 designs, four tasks.

use crate::experiments::{self, Experiment};
use input::shipped::{MEASUREMENTS, Shipped};
use insertion::outcome::FailureClass;
use insertion::space::Design;
use insertion::stiffness::{Measurement, designs};
use serde::Deserialize;

const SIMULATION: &str = include_str!("../../../data/published_simulation.csv");

/// Source of a published range.
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
    /// Failure class that stopped the shift in the negative direction.
    pub failure_negative_offset: Option<FailureClass>,
    /// Failure class that stopped the shift in the positive direction.
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
    match origin {
        Origin::Simulation => {
            let rows = csv::Reader::from_reader(SIMULATION.as_bytes()).into_deserialize();
            rows.flatten().filter(|row: &Published| row.task == task).collect()
        }
        Origin::Bench => {
            let read = |file: &Shipped| experiments::parse(file.text, file.file);
            let lines = MEASUREMENTS.iter().flat_map(read).flatten();
            lines.filter(|line| line.task == task).filter_map(|line| row(&line)).collect()
        }
    }
}

/// An experiment with the number of its design.
fn row(experiment: &Experiment) -> Option<Published> {
    let infill = |design: &Measurement| {
        Design::infill(design.density_percent, design.direction_deg) == experiment.design
    };
    let [negative, positive] = experiment.failures;
    Some(Published {
        task: experiment.task.clone(),
        design: designs().into_iter().find(infill)?.design,
        failure_negative_offset: negative,
        failure_positive_offset: positive,
        tolerable_range_mm: experiment.range_mm(),
    })
}
