//! Rank correlation of simulated and measured ranges.

use ask_tell::statistics::{mean, spearman};
use input::shipped::TASKS;
use insertion::{Design, FingerModelKind};
use serde::{Deserialize, Serialize};
use study::StudyConfig;

/// Simulated and measured ranges: some columns of the committed `results/reference/validation/validation.csv`.
const VALIDATION: &str = include_str!("../../../data/simulated_ranges.csv");

/// Rank correlation of simulated and measured ranges on a task.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RankCorrelation {
    /// Name of the task.
    pub task: String,
    /// Spearman's coefficient, +1 for the same order, -1 for the opposite one.
    pub spearman: f64,
    /// Number of fingers.
    #[serde(rename = "designs")]
    pub fingers: usize,
    /// Source of the simulated ranges, in words.
    pub source: &'static str,
    /// Finger with the largest measured range.
    pub best: ComparedFinger,
}

/// Relation of the simulated order of the fingers to the measured one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// The same, by more than chance.
    Like,
    /// Neither the same nor the opposite by more than chance.
    Chance,
    /// The opposite, by more than chance.
    Opposite,
}

impl RankCorrelation {
    /// Returns the relation of the orders. A random order of n fingers has a rank correlation of mean 0 and variance
    /// 1 / (n - 1), taken as normal: its magnitude exceeds the bound in less than 10 % of cases.
    pub fn order(&self) -> Order {
        match self.spearman * (self.fingers as f64 - 1.0).sqrt() {
            z if z > 1.645 => Order::Like,
            z if z < -1.645 => Order::Opposite,
            _ => Order::Chance,
        }
    }
}

/// Finger with a simulated and a measured range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedFinger {
    /// Its design.
    #[serde(rename = "values")]
    pub design: Design,
    /// Simulated range, mm.
    #[serde(rename = "simulated_range_mm")]
    pub simulated_mm: f64,
    /// Range measured on a robot, mm.
    #[serde(rename = "measured_range_mm")]
    pub measured_mm: f64,
}

/// Robot of the committed validation, whose fingers are those of the paper.
const VALIDATION_ROBOT: &str = "servo";

/// Row of the committed validation.
#[derive(Deserialize)]
struct ValidationRow {
    task: String,
    infill_density_percent: f64,
    infill_direction_deg: f64,
    range_mm: Option<f64>,
    bench_range_mm: Option<f64>,
}

/// Returns the rank correlation on a task in the committed validation; `None` for a user's own task.
pub fn rank_correlation(config: &StudyConfig, task: &str) -> Option<RankCorrelation> {
    let like_validation =
        config.finger_model == FingerModelKind::Paper && config.robot == VALIDATION_ROBOT;
    let source = if like_validation { "model" } else { "model with paper fingers on servo" };
    let compared = validation(task);
    let (spearman, fingers) = (spearman(&pairs(&compared))?, compared.len());
    let widest = |a: &ComparedFinger, b: &ComparedFinger| a.measured_mm.total_cmp(&b.measured_mm);
    let best = compared.into_iter().max_by(widest)?;
    Some(RankCorrelation { task: task.to_owned(), spearman, fingers, source, best })
}

/// Returns the simulated and the measured ranges of fingers, mm.
fn pairs(compared: &[ComparedFinger]) -> Vec<(f64, f64)> {
    compared.iter().map(|finger| (finger.simulated_mm, finger.measured_mm)).collect()
}

/// Returns the fingers of the committed validation that have both ranges.
fn validation(task: &str) -> Vec<ComparedFinger> {
    let rows = csv::Reader::from_reader(VALIDATION.as_bytes()).into_deserialize();
    let own = rows.flatten().filter(|row: &ValidationRow| row.task == task);
    let compared = |row: ValidationRow| {
        Some(ComparedFinger {
            design: Design::infill(row.infill_density_percent, row.infill_direction_deg),
            simulated_mm: row.range_mm?,
            measured_mm: row.bench_range_mm?,
        })
    };
    own.filter_map(compared).collect()
}

/// Returns the smallest and the largest over the tasks of the mean of `|simulated - measured| / measured`, percent.
pub fn errors_percent() -> [f64; 2] {
    let errors = TASKS.iter().filter_map(|task| {
        let pairs = pairs(&validation(task.name));
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
        for (task, fingers, rank, order) in [
            ("ket8", 11, -0.62, Order::Opposite),
            ("ket12", 7, 0.85, Order::Like),
            ("rj45", 11, 0.58, Order::Like),
            ("usb", 11, -0.07, Order::Chance),
        ] {
            let compared = validation(task);
            let (found, source) = (pairs(&compared), "");
            assert_eq!(found.len(), fingers, "{task}");
            let (spearman, best) = (spearman(&found).unwrap(), compared[0].clone());
            assert!((spearman - rank).abs() < 0.005, "{task}");
            let found = RankCorrelation { task: task.into(), spearman, fingers, source, best };
            assert_eq!(found.order(), order, "{task}");
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
