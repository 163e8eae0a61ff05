//! Rank correlation of simulated and measured ranges.

use crate::experiments::Experiment;
use crate::published::{BENCH, of_task};
use ask_tell::statistics::{mean, spearman};
use input::shipped::TASKS;
use insertion::evaluation::objective::Measure;
use insertion::finger::model::FingerModelKind;
use serde::Deserialize;
use study::StudyRecord;

/// Simulated and measured ranges: some columns of the committed `results/reference/validation/validation.csv`.
const VALIDATION: &str = include_str!("../../../data/simulated_ranges.csv");

/// Rank correlation of simulated and measured ranges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RankCorrelation {
    /// Spearman's coefficient, +1 for the same order, -1 for the opposite one.
    pub spearman: f64,
    /// Number of fingers.
    pub fingers: usize,
    /// Source of the simulated ranges, in words.
    pub source: &'static str,
}

/// Robot of the committed validation, whose fingers are those of the paper.
const VALIDATION_ROBOT: &str = "servo";

/// Row of the committed validation.
#[derive(Deserialize)]
struct ValidationRow {
    task: String,
    range_mm: Option<f64>,
    bench_range_mm: Option<f64>,
}

/// Returns the rank correlation on a task: of the study's own ranges if it simulated all measured fingers, else of the
/// committed validation.
pub fn rank_correlation(record: &StudyRecord, task: usize) -> Option<RankCorrelation> {
    let name = record.config.tasks().nth(task)?;
    let bench = of_task(name, BENCH);
    let pair = |bench: &Experiment| {
        let found = record.current().iter().find(|recorded| recorded.design == bench.design)?;
        Some((Measure::Range.value(found.on(task)?)?, bench.range_mm?))
    };
    let own: Vec<(f64, f64)> = bench.iter().filter_map(pair).collect();
    let all = bench.iter().filter(|bench| bench.range_mm.is_some()).count();
    let config = &record.config;
    let like_validation =
        config.finger_model == FingerModelKind::Paper && config.robot == VALIDATION_ROBOT;
    let (pairs, source) = match (own.len() == all, like_validation) {
        (true, _) => (own, "this study"),
        (false, true) => (validation(name), "our validation"),
        (false, false) => (validation(name), "our validation (paper fingers on servo)"),
    };
    Some(RankCorrelation { spearman: spearman(&pairs)?, fingers: pairs.len(), source })
}

/// Returns the simulated and the measured range of each finger in the committed validation.
fn validation(task: &str) -> Vec<(f64, f64)> {
    let rows = csv::Reader::from_reader(VALIDATION.as_bytes()).into_deserialize();
    let own = rows.flatten().filter(|row: &ValidationRow| row.task == task);
    own.filter_map(|row| row.range_mm.zip(row.bench_range_mm)).collect()
}

/// Returns the smallest and the largest over the tasks of the mean of `|simulated - measured| / measured`, percent.
pub fn errors_percent() -> [f64; 2] {
    let errors = TASKS.iter().filter_map(|task| {
        let pairs = validation(task.name);
        let missed = pairs.iter().map(|(ours, bench)| (ours - bench).abs() / bench);
        mean(missed).map(|mean| 100.0 * mean)
    });
    errors.fold([f64::INFINITY, 0.0], |[least, most], error| [least.min(error), most.max(error)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Recomputes the table of the README from the committed ranges.
    #[test]
    fn the_committed_validation_has_these_rank_correlations() {
        for (task, pairs, rank) in
            [("ket8", 11, -0.62), ("ket12", 7, 0.85), ("rj45", 11, 0.58), ("usb", 11, -0.07)]
        {
            let found = validation(task);
            assert_eq!(found.len(), pairs, "{task}");
            assert!((spearman(&found).unwrap() - rank).abs() < 0.005, "{task}");
        }
        assert!(validation("mine").is_empty());
    }

    #[test]
    fn the_ranges_are_those_of_the_committed_validation() {
        let whole = include_str!("../../../results/reference/validation/validation.csv");
        let cut = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            [0, 1, 2, 3, 9, 15].map(|column| cells[column]).join(",") + "\n"
        };
        assert_eq!(whole.lines().map(cut).collect::<String>(), VALIDATION);
    }
}
