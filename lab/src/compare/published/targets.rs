//! What we ask of our simulation against the published one, and whether it holds.

use super::{RangeSource, TaskTable, agreement::Agreement};

/// Largest mean absolute error of the range, mm.
const LARGEST_ERROR_MM: f64 = 1.0;
/// Smallest rank correlation on the tasks of [`VARYING`].
const SMALLEST_SPEARMAN: f64 = 0.7;
/// Tasks whose published simulated range varies enough over the designs to be ranked.
const VARYING: [&str; 2] = ["ket8", "usb"];
/// Smallest failure match score, percent.
const SMALLEST_MATCH_PERCENT: f64 = 70.0;

/// A target on one task.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// What is asked.
    pub quantity: &'static str,
    /// What was found; `None` if it is not defined.
    pub found: Option<f64>,
    /// The limit.
    pub limit: f64,
    /// Unit of both; empty for pure numbers.
    pub unit: &'static str,
    /// Whether the limit is the largest allowed, not the smallest.
    pub at_most: bool,
}

impl Target {
    /// Whether it is met; a value that is not defined meets nothing.
    pub fn met(&self) -> bool {
        self.found.is_some_and(|found| match self.at_most {
            true => found <= self.limit,
            false => found >= self.limit,
        })
    }
}

/// The targets of a task, all against the published simulation.
pub fn targets(table: &TaskTable) -> Vec<Target> {
    let agreement = Agreement::of(&table.rows, RangeSource::Ours, RangeSource::Simulation);
    let mut targets = vec![Target {
        quantity: "mean absolute error of the range",
        found: agreement.mean_absolute_error_mm,
        limit: LARGEST_ERROR_MM,
        unit: "mm",
        at_most: true,
    }];
    if VARYING.contains(&table.task.as_str()) {
        targets.push(Target {
            quantity: "rank correlation (Spearman)",
            found: agreement.spearman,
            limit: SMALLEST_SPEARMAN,
            unit: "",
            at_most: false,
        });
    }
    targets.push(Target {
        quantity: "nominal starts that insert",
        found: Some(table.nominal_inserted() as f64),
        limit: table.rows.len() as f64,
        unit: "",
        at_most: false,
    });
    targets.push(Target {
        quantity: "failure classes matched",
        found: agreement.match_percent(),
        limit: SMALLEST_MATCH_PERCENT,
        unit: "%",
        at_most: false,
    });
    targets
}
