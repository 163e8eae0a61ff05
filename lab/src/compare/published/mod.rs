//! Comparison of our tolerance windows with the published ones.

mod table;
#[cfg(test)]
mod tests;

pub use table::{accuracy, csv};

use super::failures;
use ask_tell::statistics::{mean, spearman};
use calibration::published::{self, BENCH, SIMULATION};
use insertion::evaluation::Window;
use insertion::evaluation::taught::{Shifted, teach};
use insertion::evaluation::template::DesignError;
use insertion::evaluation::tolerance::{self, Search};
use insertion::finger::model::FingerSource;
use insertion::outcome::{FailureClass, Outcome};
use insertion::robot::Robot;
use insertion::space::Design;
use insertion::stiffness::Measurement;
use insertion::surrogate::Prediction;
use insertion::task::{StartRule, Task};
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use rayon::prelude::*;

/// Compared sources, each with its reference: 0 our simulation, 1 the published simulation, 2 the published experiments.
pub const COMPARISONS: [[usize; 2]; 3] = [[0, 1], [0, 2], [1, 2]];

/// Tolerable range and the failure classes at its ends, from one source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    pub range_mm: Option<f64>,
    pub failure_negative: Option<FailureClass>,
    pub failure_positive: Option<FailureClass>,
}

/// Results of a design on a task: our window, and the reading from each source.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignRow {
    pub design: Measurement,
    pub window: Window,
    /// Reading of each source, numbered as in [`COMPARISONS`].
    pub readings: [Option<Reading>; 3],
}

impl DesignRow {
    pub fn range_mm(&self, source: usize) -> Option<f64> {
        self.readings[source]?.range_mm
    }
}

/// Results of all designs on a task.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskTable {
    pub task: String,
    pub rows: Vec<DesignRow>,
}

impl TaskTable {
    pub fn new(task: &str, windows: impl IntoIterator<Item = (Measurement, Window)>) -> Self {
        let published = [SIMULATION, BENCH].map(|table| published::of_task(task, table));
        let row = |(design, window): (Measurement, Window)| {
            let infill = Design::infill(design.density_percent, design.direction_deg);
            let [simulation, bench] = published.each_ref().map(|rows| {
                let row = rows.iter().find(|row| row.design == infill)?;
                Some(Reading {
                    range_mm: row.range_mm,
                    failure_negative: row.failure_negative,
                    failure_positive: row.failure_positive,
                })
            });
            // If the nominal start diverges, the range is unknown; if it fails, the range is 0. Neither has ends.
            let range_mm = (window.nominal != Outcome::Diverged).then(|| window.range_mm());
            let [failure_negative, failure_positive] = failures(&window);
            let ours = Reading { range_mm, failure_negative, failure_positive };
            let readings = [Some(ours), simulation, bench];
            DesignRow { design, window, readings }
        };
        TaskTable { task: task.to_owned(), rows: windows.into_iter().map(row).collect() }
    }

    /// Returns the agreement of each of [`COMPARISONS`].
    pub fn agreements(&self) -> [Agreement; 3] {
        COMPARISONS.map(|compared| Agreement::new(&self.rows, compared))
    }
}

/// Agreement of one source with another (the reference) over the designs of a task.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Mean of `|range - reference|` over the designs with a range from both, mm; `None` without designs.
    pub mean_absolute_error_mm: Option<f64>,
    /// Rank correlation over the same designs, -1 to 1; see [`spearman`].
    pub spearman: Option<f64>,
    /// The paper's failure match score: of the window ends with a failure class from the reference, the share with the
    /// same class from both, percent; `None` without ends.
    pub match_percent: Option<f64>,
}

impl Agreement {
    /// Compares a source with a reference, numbered as in [`COMPARISONS`].
    ///
    /// An end without a class from the source counts as not matched.
    pub fn new(rows: &[DesignRow], [compared, reference]: [usize; 2]) -> Self {
        let both = |row: &DesignRow| row.readings[compared].zip(row.readings[reference]);
        let readings: Vec<_> = rows.iter().filter_map(both).collect();
        let pairs: Vec<(f64, f64)> =
            readings.iter().filter_map(|(a, b)| a.range_mm.zip(b.range_mm)).collect();
        let ends: Vec<_> = readings
            .iter()
            .flat_map(|(a, b)| {
                let negative = (a.failure_negative, b.failure_negative);
                [negative, (a.failure_positive, b.failure_positive)]
            })
            .filter(|(_, reference)| reference.is_some())
            .collect();
        let matched_ends = ends.iter().filter(|(a, b)| a == b).count();
        let match_percent = 100.0 * matched_ends as f64 / ends.len() as f64;
        Agreement {
            mean_absolute_error_mm: mean(pairs.iter().map(|(a, b)| (a - b).abs())),
            spearman: spearman(&pairs),
            match_percent: (!ends.is_empty()).then_some(match_percent),
        }
    }
}

/// Returns the paper's deviation, `|range - reference| / reference`, in percent.
pub fn deviation_percent(range: f64, reference: f64) -> f64 {
    100.0 * (range - reference).abs() / reference
}

/// Determines the windows of all designs, with their measured stiffness, on all tasks. By the rule of the task, a
/// window is about the start in the task file or the taught start; if no start can be taught, about the former.
pub fn windows(
    fingers: &FingerSource,
    robot: &Robot,
    engine: EngineKind,
    search: Search,
    tasks: &[Task],
    designs: &[Measurement],
) -> Result<Vec<TaskTable>, DesignError> {
    let window = |task: &Task, design: &Measurement| {
        let Measurement { compliance, assembly, density_percent, direction_deg, .. } = *design;
        let infill = Design::infill(density_percent, direction_deg);
        let finger = fingers.make(&Prediction::exact(compliance, assembly), &infill, task)?;
        let rig = engine.rig(task, robot, &finger, 1.0)?;
        let taught = match task.strategy.rule {
            StartRule::Given => None,
            StartRule::Taught => teach(&*rig, &finger, &NEVER).ok(),
        };
        let moved = Shifted { rig: &*rig, shift: taught.map_or(0, |taught| taught.shift) };
        Ok((*design, tolerance::evaluate(&moved, &finger, search).window))
    };
    let table = |task: &Task| {
        let windows = designs.par_iter().map(|design| window(task, design));
        Ok(TaskTable::new(&task.name, windows.collect::<Result<Vec<_>, DesignError>>()?))
    };
    tasks.par_iter().map(table).collect()
}
