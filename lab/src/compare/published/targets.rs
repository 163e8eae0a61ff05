//! Targets for the agreement of our simulation with the published one.

use super::{Agreement, RangeSource, TaskTable};
use serde::Serialize;

/// Largest mean absolute error of the range, mm.
const LARGEST_ERROR_MM: f64 = 1.0;
/// Smallest rank correlation on the tasks of [`VARYING`].
const SMALLEST_SPEARMAN: f64 = 0.7;
/// Tasks whose published simulated range varies enough over the designs to be ranked.
const VARYING: [&str; 2] = ["ket8", "usb"];
/// Smallest failure match score, percent.
const SMALLEST_MATCH_PERCENT: f64 = 70.0;

/// Target on a task.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Target {
    pub quantity: &'static str,
    /// Value found; `None` if it is not defined, which meets nothing.
    pub found: Option<f64>,
    pub limit: f64,
    /// Unit of both; empty for pure numbers.
    pub unit: &'static str,
    pub limit_is: Limit,
    pub met: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Limit {
    Largest,
    Smallest,
}

/// Targets of a task, all against the published simulation.
pub fn targets(table: &TaskTable) -> Vec<Target> {
    let agreement = Agreement::of(&table.rows, RangeSource::Ours, RangeSource::Simulation);
    let target = |quantity, found: Option<f64>, limit_is, limit, unit| {
        let met = found.is_some_and(|found| match limit_is {
            Limit::Largest => found <= limit,
            Limit::Smallest => found >= limit,
        });
        Target { quantity, found, limit, unit, limit_is, met }
    };
    let at_least =
        |quantity, found, limit, unit| target(quantity, found, Limit::Smallest, limit, unit);
    let error = agreement.mean_absolute_error_mm;
    let quantity = "mean absolute error of the range";
    let mut targets = vec![target(quantity, error, Limit::Largest, LARGEST_ERROR_MM, "mm")];
    if VARYING.contains(&table.task.as_str()) {
        let quantity = "rank correlation (Spearman)";
        targets.push(at_least(quantity, agreement.spearman, SMALLEST_SPEARMAN, ""));
    }
    let (inserted, all) = (table.nominal_inserted() as f64, table.rows.len() as f64);
    targets.push(at_least("nominal starts that insert", Some(inserted), all, ""));
    let matched = agreement.match_percent;
    targets.push(at_least("failure classes matched", matched, SMALLEST_MATCH_PERCENT, "%"));
    targets
}
