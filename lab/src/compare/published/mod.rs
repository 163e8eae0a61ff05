//! Our tolerance windows beside the published ones: tables and statistics,
//! pure functions of windows that were measured elsewhere.

mod accuracy;
mod agreement;
mod table;
mod targets;
#[cfg(test)]
mod tests;
mod text;

pub use accuracy::{accuracy, accuracy_json};
pub use agreement::Agreement;
pub use table::{CSV_HEADER, SUMMARY_HEADER, csv, json, summary_csv};
pub use targets::{Target, targets};
pub use text::text;

use super::failures;
use finger_opt::calibration::published::{self, Origin, Published};
use insertion::evaluation::Window;
use insertion::outcome::{FailureClass, Outcome};
use insertion::stiffness::Measurement;

/// Where a range and the failures at its ends come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RangeSource {
    /// This program's simulation.
    Ours,
    /// The publication's simulation.
    Simulation,
    /// The publication's experiments on the robot.
    Bench,
}

impl RangeSource {
    /// A name for tables and plots.
    pub fn label(self) -> &'static str {
        match self {
            RangeSource::Ours => "ours",
            RangeSource::Simulation => "published simulation",
            RangeSource::Bench => "bench experiments",
        }
    }

    /// A name for keys and columns.
    pub fn key(self) -> &'static str {
        match self {
            RangeSource::Ours => "ours",
            RangeSource::Simulation => "simulation",
            RangeSource::Bench => "bench",
        }
    }
}

/// What is compared with what.
pub const COMPARISONS: [(RangeSource, RangeSource); 3] = [
    (RangeSource::Ours, RangeSource::Simulation),
    (RangeSource::Ours, RangeSource::Bench),
    (RangeSource::Simulation, RangeSource::Bench),
];

/// Range and failures of one design according to one source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Tolerable range, mm; `None` if there is none.
    pub range_mm: Option<f64>,
    /// Failure at the negative and at the positive end of the window, if there is one.
    pub failures: [Option<FailureClass>; 2],
}

/// One measured design: our window and what was published of it.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignRow {
    /// The design and its measured stiffness.
    pub design: Measurement,
    /// Our window.
    pub window: Window,
    simulation: Option<Reading>,
    bench: Option<Reading>,
}

impl DesignRow {
    /// What a source says of this design, if anything.
    pub fn reading(&self, source: RangeSource) -> Option<Reading> {
        match source {
            RangeSource::Ours => Some(Reading::from(&self.window)),
            RangeSource::Simulation => self.simulation,
            RangeSource::Bench => self.bench,
        }
    }

    /// The range according to a source, mm.
    pub fn range_mm(&self, source: RangeSource) -> Option<f64> {
        self.reading(source)?.range_mm
    }
}

impl From<&Window> for Reading {
    /// A nominal start that diverges says nothing of the range; one that fails
    /// makes it 0. Either way there is no window, so no ends to be credited with.
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
    /// Name of the task.
    pub task: String,
    /// One row per design, in the order of the designs.
    pub rows: Vec<DesignRow>,
}

impl TaskTable {
    /// Puts windows beside what is published of a task.
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

    /// The agreement of each pair of [`COMPARISONS`].
    pub fn agreements(&self) -> [Agreement; 3] {
        COMPARISONS.map(|(source, reference)| Agreement::of(&self.rows, source, reference))
    }

    /// Designs whose nominal start inserts.
    pub fn nominal_inserted(&self) -> usize {
        self.rows.iter().filter(|row| row.window.nominal == Outcome::Inserted).count()
    }
}
