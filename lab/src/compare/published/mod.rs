//! Our tolerance windows beside the published ones: tables and statistics, pure functions of windows.

mod agreement;
mod table;
#[cfg(test)]
mod tests;

pub use agreement::Agreement;
pub use table::{accuracy, csv, json};

use super::failures;
use finger_opt::calibration::published::{self, Origin, Published};
use insertion::evaluation::Window;
use insertion::outcome::{FailureClass, Outcome};
use insertion::stiffness::Measurement;
use serde::Serialize;

/// Source of a range and the failures at its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RangeSource {
    /// This program's simulation.
    Ours,
    /// The publication's simulation.
    Simulation,
    /// The publication's experiments on the robot.
    Bench,
}

/// Compared sources, each with its reference.
pub const COMPARISONS: [(RangeSource, RangeSource); 3] = [
    (RangeSource::Ours, RangeSource::Simulation),
    (RangeSource::Ours, RangeSource::Bench),
    (RangeSource::Simulation, RangeSource::Bench),
];

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reading {
    /// Tolerable range, mm; `None` if the source gives none.
    pub range_mm: Option<f64>,
    pub failure_negative: Option<FailureClass>,
    pub failure_positive: Option<FailureClass>,
}

/// Measured design with our window and the published readings.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignRow {
    pub design: Measurement,
    pub window: Window,
    simulation: Option<Reading>,
    bench: Option<Reading>,
}

impl DesignRow {
    pub fn reading(&self, source: RangeSource) -> Option<Reading> {
        match source {
            RangeSource::Ours => Some(Reading::from(&self.window)),
            RangeSource::Simulation => self.simulation,
            RangeSource::Bench => self.bench,
        }
    }
}

impl From<&Window> for Reading {
    /// A nominal start that diverges gives no range; one that fails gives 0. Either way there is no
    /// window, so no ends to be credited with.
    fn from(window: &Window) -> Self {
        let range_mm = (window.nominal != Outcome::Diverged).then(|| window.range_mm());
        let [failure_negative, failure_positive] = failures(window);
        Reading { range_mm, failure_negative, failure_positive }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct TaskTable {
    pub task: String,
    pub rows: Vec<DesignRow>,
}

impl TaskTable {
    /// Table of our windows beside the published readings of a task.
    pub fn new(task: &str, windows: impl IntoIterator<Item = (Measurement, Window)>) -> Self {
        let published = [Origin::Simulation, Origin::Bench].map(|of| published::of_task(task, of));
        let reading = |row: &Published| Reading {
            range_mm: row.tolerable_range_mm,
            failure_negative: row.failure_negative_offset,
            failure_positive: row.failure_positive_offset,
        };
        let row = |(design, window): (Measurement, Window)| {
            let [simulation, bench] = published
                .each_ref()
                .map(|rows| rows.iter().find(|row| row.design == design.design).map(reading));
            DesignRow { design, window, simulation, bench }
        };
        TaskTable { task: task.to_owned(), rows: windows.into_iter().map(row).collect() }
    }

    pub fn agreements(&self) -> [Agreement; 3] {
        COMPARISONS.map(|(source, reference)| Agreement::of(&self.rows, source, reference))
    }
}
