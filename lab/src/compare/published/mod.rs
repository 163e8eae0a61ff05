//! Our tolerance windows beside the published ones: tables and statistics, pure functions of windows.

mod table;
#[cfg(test)]
mod tests;

pub use table::{accuracy, csv, json};

use super::failures;
use ask_tell::statistics::{mean, spearman};
use calibration::published::{self, Origin, Published};
use insertion::evaluation::Window;
use insertion::evaluation::taught::{Moved, teach};
use insertion::evaluation::template::Impossible;
use insertion::evaluation::tolerance::{self, Search};
use insertion::finger::computed::AtPad;
use insertion::finger::model::FingerSource;
use insertion::outcome::{FailureClass, Outcome};
use insertion::robot::Robot;
use insertion::space::Design;
use insertion::stiffness::Measurement;
use insertion::task::{StartRule, Task};
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use rayon::prelude::*;
use serde::Serialize;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RangeSource {
    Ours,
    Simulation,
    Bench,
}

pub const COMPARISONS: [(RangeSource, RangeSource); 3] = [
    (RangeSource::Ours, RangeSource::Simulation),
    (RangeSource::Ours, RangeSource::Bench),
    (RangeSource::Simulation, RangeSource::Bench),
];

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reading {
    pub range_mm: Option<f64>,
    pub failure_negative: Option<FailureClass>,
    pub failure_positive: Option<FailureClass>,
}

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
    /// A start that diverges gives no range, one that fails gives 0; neither has window ends.
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

/// Agreement of one source with another (the reference) over the designs of a task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Agreement {
    #[serde(rename = "compared")]
    pub source: RangeSource,
    pub reference: RangeSource,
    /// Designs for which both give a range; the next four values rest on them.
    pub designs: usize,
    /// Mean of `|range - reference|`, mm; `None` without designs.
    pub mean_absolute_error_mm: Option<f64>,
    /// Mean of `range - reference`, mm: an offset common to all designs.
    pub mean_error_mm: Option<f64>,
    /// Mean of `|range - reference|` over the reference, percent.
    pub mean_deviation_percent: Option<f64>,
    /// Rank correlation, -1 to 1; see [`spearman`].
    pub spearman: Option<f64>,
    /// Window ends at which both name the same failure class.
    pub matched_ends: usize,
    /// Window ends for which the reference names a class.
    pub ends: usize,
    /// Failure match score, percent: the paper's, over both ends of all windows.
    pub match_percent: Option<f64>,
}

impl Agreement {
    /// Compares two columns of a task's rows.
    ///
    /// An end at which the source names no class counts as not matched.
    pub fn of(rows: &[DesignRow], source: RangeSource, reference: RangeSource) -> Self {
        let readings: Vec<_> = rows
            .iter()
            .filter_map(|row| Some((row.reading(source)?, row.reading(reference)?)))
            .collect();
        let pairs: Vec<(f64, f64)> =
            readings.iter().filter_map(|(a, b)| Some((a.range_mm?, b.range_mm?))).collect();
        let ends = || {
            let both = readings.iter().flat_map(|(a, b)| {
                [(a.failure_negative, b.failure_negative), (a.failure_positive, b.failure_positive)]
            });
            both.filter(|(_, reference)| reference.is_some())
        };
        let over =
            |measure: &dyn Fn(f64, f64) -> f64| mean(pairs.iter().map(|&(a, b)| measure(a, b)));
        let matched_ends = ends().filter(|(a, b)| a == b).count();
        Agreement {
            source,
            reference,
            designs: pairs.len(),
            mean_absolute_error_mm: over(&|a, b| (a - b).abs()),
            mean_error_mm: over(&|a, b| a - b),
            mean_deviation_percent: over(&deviation_percent),
            spearman: spearman(&pairs),
            matched_ends,
            ends: ends().count(),
            match_percent: match ends().count() {
                0 => None,
                ends => Some(100.0 * matched_ends as f64 / ends as f64),
            },
        }
    }
}

/// The paper's deviation: `|range - reference| / reference`, percent.
pub fn deviation_percent(range: f64, reference: f64) -> f64 {
    100.0 * (range - reference).abs() / reference
}

/// Windows of all designs, as stiff as measured, on all tasks, each about its task's start.
pub fn windows(
    fingers: &FingerSource,
    robot: &Robot,
    engine: EngineKind,
    search: Search,
    tasks: &[Task],
    designs: &[Measurement],
) -> Result<Vec<TaskTable>, Impossible> {
    let window = |(task, design): (&Task, &Measurement)| {
        let Measurement { compliance, assembly, density_percent, direction_deg, .. } = *design;
        let infill = Design::infill(density_percent, direction_deg);
        let finger = fingers.make(AtPad { compliance, assembly }, &infill, task)?.finger;
        let rig = engine.rig(task, robot, &finger, 1.0)?;
        let taught = match task.strategy.rule {
            StartRule::Given => None,
            StartRule::Taught => teach(&*rig, &finger, &NEVER).ok(),
        };
        let moved = Moved { rig: &*rig, by: taught.map_or(0, |taught| taught.by) };
        Ok(tolerance::evaluate(&moved, &finger, search).window)
    };
    let pairs = tasks.iter().flat_map(|task| designs.iter().map(move |design| (task, design)));
    let pairs = pairs.collect::<Vec<_>>().into_par_iter();
    let windows = pairs.map(window).collect::<Result<Vec<Window>, Impossible>>()?;
    let table = |(task, found): (&Task, &[Window])| {
        TaskTable::new(&task.name, designs.iter().copied().zip(found.iter().cloned()))
    };
    Ok(tasks.iter().zip(windows.chunks(designs.len().max(1))).map(table).collect())
}
