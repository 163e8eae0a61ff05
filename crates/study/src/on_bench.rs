//! Prediction of the ranges of a study's fingers on the bench (the real robot) from measurements there:
//! `bench.json` beside the journal. It is computed after the search, does not affect it, and can be repeated.

use super::{BenchEffort, Provenance, read_analysis};
use insertion::{Design, Evaluation, FailureClass};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// File of the prediction in the folder of a study.
pub const BENCH_FILE: &str = "bench.json";

/// Bench ranges of a study's fingers, predicted by calibration to measurements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BenchPrediction {
    /// Provenance for which the prediction is valid.
    pub provenance: Provenance,
    /// Effort of the prediction.
    pub effort: BenchEffort,
    /// Number of measured fingers.
    pub measured: usize,
    /// Measured fingers with both ends of the range, and that range, mm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ranges: Vec<(Design, f64)>,
    /// The other measured fingers, with a lower bound of their range, mm, if there is one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bounds: Vec<(Design, Option<f64>)>,
    /// Number of fingers of the space that were predicted.
    pub fingers: usize,
    /// Leave-one-out validation.
    pub trust: LeaveOneOut,
    /// Warnings, one line each.
    pub warnings: Vec<String>,
    /// The fingers of largest predicted range and the one most probably the best, by range; at least one.
    pub best: Vec<BenchFinger>,
    /// Simulated evaluation of the first of them with the nominal parameters of the task file.
    pub simulated: Evaluation,
}

impl BenchPrediction {
    /// Reads the prediction in `dir`; returns `None` if it is missing, damaged or of another provenance.
    pub(super) fn read(dir: &Path, provenance: &Provenance) -> Option<BenchPrediction> {
        let found: BenchPrediction = read_analysis(dir, BENCH_FILE)?;
        (found.provenance == *provenance && !found.best.is_empty()).then_some(found)
    }
}

/// Leave-one-out validation: each measured finger predicted without its own measurements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeaveOneOut {
    /// Number of fingers.
    pub fingers: usize,
    /// Mean of `|predicted - measured| / measured`, percent.
    pub mean_deviation_percent: Option<f64>,
    /// Rank correlation of predicted and measured ranges.
    pub spearman: Option<f64>,
    /// Number of fingers inside their 80 % intervals.
    pub inside: usize,
    /// Root mean square error of the emulator, mm.
    pub emulator_error_mm: f64,
}

/// Predicted bench range of a finger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BenchFinger {
    /// The design.
    pub design: Design,
    /// Mean of the predicted range, mm.
    pub range_mm: f64,
    /// Lower end of its 80 % interval, mm.
    pub low_mm: f64,
    /// Upper end of the interval, mm.
    pub high_mm: f64,
    /// Probability that the finger is the best of the space, 0 to 1.
    pub probability_best: f64,
    /// Simulated failure classes below and above the window.
    pub failures: [Option<FailureClass>; 2],
}
