//! Our tolerance windows beside the published ones: tables and statistics, pure functions of windows.

mod accuracy;
mod agreement;
mod table;
mod targets;
#[cfg(test)]
mod tests;
mod text;

pub use accuracy::{accuracy, accuracy_json};
pub use agreement::Agreement;
pub use table::{csv, json, summary_csv};
pub use text::text;

use super::failures;
use finger_opt::calibration::published::{self, Origin, Published};
use insertion::evaluation::Window;
use insertion::outcome::{FailureClass, Outcome};
use insertion::stiffness::Measurement;

/// Source of a range and the failures at its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RangeSource {
    /// This program's simulation.
    Ours,
    /// The publication's simulation.
    Simulation,
    /// The publication's experiments on the robot.
    Bench,
}

impl RangeSource {
    /// Names in text and in files.
    pub fn names(self) -> [&'static str; 2] {
        match self {
            RangeSource::Ours => ["ours", "ours"],
            RangeSource::Simulation => ["published simulation", "simulation"],
            RangeSource::Bench => ["bench experiments", "bench"],
        }
    }
}

/// Compared sources, each with its reference.
pub const COMPARISONS: [(RangeSource, RangeSource); 3] = [
    (RangeSource::Ours, RangeSource::Simulation),
    (RangeSource::Ours, RangeSource::Bench),
    (RangeSource::Simulation, RangeSource::Bench),
];

/// Range and failures of a design from one source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Tolerable range, mm; `None` if the source gives none.
    pub range_mm: Option<f64>,
    /// Failure at the negative and at the positive end of the window.
    pub failures: [Option<FailureClass>; 2],
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
    /// Reading of a source, if it has the design.
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
        Reading {
            range_mm: (window.nominal != Outcome::Diverged).then(|| window.range_mm()),
            failures: failures(window),
        }
    }
}

impl From<&Published> for Reading {
    fn from(row: &Published) -> Self {
        Reading {
            range_mm: row.tolerable_range_mm,
            failures: [row.failure_negative_offset, row.failure_positive_offset],
        }
    }
}

/// All measured designs on one task.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskTable {
    pub task: String,
    /// A row for each design, in order.
    pub rows: Vec<DesignRow>,
}

impl TaskTable {
    /// Table of our windows beside the published readings of a task.
    pub fn new(task: &str, windows: impl IntoIterator<Item = (Measurement, Window)>) -> Self {
        let [simulation, bench] =
            [Origin::Simulation, Origin::Bench].map(|origin| published::of_task(task, origin));
        let find = |rows: &[Published], design| {
            rows.iter().find(|row| row.design == design).map(Reading::from)
        };
        let row = |(design, window): (Measurement, Window)| DesignRow {
            simulation: find(&simulation, design.design),
            bench: find(&bench, design.design),
            design,
            window,
        };
        TaskTable { task: task.to_owned(), rows: windows.into_iter().map(row).collect() }
    }

    /// Agreement of each pair of [`COMPARISONS`].
    pub fn agreements(&self) -> [Agreement; 3] {
        COMPARISONS.map(|(source, reference)| Agreement::of(&self.rows, source, reference))
    }

    /// Designs whose nominal start inserts.
    pub fn nominal_inserted(&self) -> usize {
        self.rows.iter().filter(|row| row.window.nominal == Outcome::Inserted).count()
    }
}
