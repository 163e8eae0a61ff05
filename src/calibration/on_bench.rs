//! A calibration as a study keeps it: which fingers are the best on the bench.

use super::calibrate::{Prediction, TaskResult};
use super::loo::Accuracy;
use super::subject::Subject;
use super::table::warnings;
use crate::study::{BenchEffort, BenchFinger, OnBench, Provenance, Trust};
use insertion::evaluation::Evaluation;

const KEPT: usize = 5;

/// The fingers of the space by their predicted ranges, best first.
pub fn by_range(result: &TaskResult) -> Vec<&Prediction> {
    let mut order: Vec<&Prediction> = result.predictions.iter().collect();
    order.sort_by(|a, b| b.range.mean_mm.total_cmp(&a.range.mean_mm));
    order
}

/// Prediction of a calibration for a study's one task; `simulated` is the best finger's evaluation.
pub fn on_bench(
    subject: &Subject,
    result: &TaskResult,
    simulated: Evaluation,
    provenance: Provenance,
    effort: BenchEffort,
) -> OnBench {
    let accuracy = Accuracy::of(&result.left_out);
    let finger = |prediction: &&Prediction| BenchFinger {
        design: subject.designs[prediction.finger].clone(),
        range_mm: prediction.range.mean_mm,
        low_mm: prediction.range.low_mm,
        high_mm: prediction.range.high_mm,
        probability_best: prediction.best,
        failures: subject.failures(prediction.finger),
    };
    OnBench {
        provenance,
        effort,
        measured: subject.measured().len(),
        fingers: result.predictions.len(),
        trust: Trust {
            fingers: accuracy.fingers,
            mean_deviation_percent: accuracy.mean_deviation_percent,
            spearman: accuracy.spearman,
            inside: accuracy.inside,
            emulator_error_mm: subject.emulator.error_mm,
        },
        warnings: warnings(subject, result),
        best: by_range(result).iter().take(KEPT).map(finger).collect(),
        simulated,
    }
}
