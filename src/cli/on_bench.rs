//! The JSON of a study with measurements: which of its fingers is the best on the bench.

use crate::study::{OnBench, StudyRecord};
use insertion::evaluation::objective::Measure;
use serde_json::{Value, json};

/// The finger that is the best on the bench; the numbers without `bench` are simulated.
pub fn recommended(record: &StudyRecord, found: &OnBench) -> Value {
    let Some(best) = found.best.first() else { return Value::Null };
    let evaluated = record.current().iter().find(|recorded| recorded.design == best.design);
    let range = Measure::Range.value(&found.simulated);
    let window = &found.simulated.window;
    json!({
        "values": best.design,
        "evaluation": evaluated.map(|recorded| recorded.index),
        "range_mm": range,
        "negative_mm": range.map(|_| window.negative_mm()),
        "positive_mm": range.map(|_| window.positive_mm()),
        "peak_force_n": Measure::PeakForce.value(&found.simulated),
        "bench": {
            "range_mm": best.range_mm,
            "low_mm": best.low_mm,
            "high_mm": best.high_mm,
            "probability_best": best.probability_best,
            "failure_negative": best.failures[0],
            "failure_positive": best.failures[1],
        },
    })
}

/// How the prediction for the bench came about, and how far it is to be trusted.
pub fn to_json(found: &OnBench) -> Value {
    json!({
        "measured": found.measured,
        "designs": found.fingers,
        "simulations": found.effort.simulations,
        "samples": found.effort.samples,
        "emulator_error_mm": found.trust.emulator_error_mm,
        "loo_mean_deviation_percent": found.trust.mean_deviation_percent,
        "loo_spearman": found.trust.spearman,
        "loo_inside": found.trust.inside,
        "loo_designs": found.trust.fingers,
        "warnings": found.warnings,
    })
}
