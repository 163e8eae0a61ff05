//! The recommendation of a study as JSON.

use crate::answer::{Answer, Recommended};
use crate::study::{ByRibs, OnBench, StudyRecord};
use insertion::evaluation::objective::Measure;
use serde_json::{Value, json};

/// `recommended`, `equivalent_designs` and `spread_mm`.
pub fn json(answer: &Answer) -> Value {
    let one = answer.recommended.as_ref().filter(|_| answer.front.is_none());
    let simulated = one.filter(|_| answer.nothing_inserts.is_none());
    let simulated = simulated.map(|found| recommended(answer.record, found));
    let mut fields = match &answer.record.on_bench {
        None => json!({ "recommended": simulated }),
        Some(bench) => json!({
            "recommended": on_bench(answer.record, bench),
            "recommended_by_simulation": simulated,
            "bench": bench_json(bench),
        }),
    };
    let equivalent = one.and_then(|found| found.as_good.as_ref()).map(|as_good| as_good.designs);
    // One decimal, without the noise of the subtraction.
    let spread = answer.spread_mm.map(|[low, high]| ((high - low) * 1e6).round() / 1e6);
    fields["equivalent_designs"] = json!(equivalent);
    fields["spread_mm"] = json!(spread);
    fields
}

fn recommended(record: &StudyRecord, found: &Recommended) -> Value {
    let window = found.range_mm.map(|_| found.window_mm);
    let mut fields = json!({
        "values": found.design.design,
        "evaluation": found.design.index,
        "firm_range_mm": found.firm_range_mm,
        "range_mm": found.range_mm,
        "negative_mm": window.map(|[negative, _]| negative),
        "positive_mm": window.map(|[_, positive]| positive),
        "firm_negative_mm": found.firm_window_mm.map(|[negative, _]| negative),
        "firm_positive_mm": found.firm_window_mm.map(|[_, positive]| positive),
        "peak_force_n": found.peak_force_n,
    });
    // What springs computed from its ribs make of the design, task by task.
    match found.by_ribs {
        Some(ByRibs::Measured(tasks)) => fields["computed"] = json!({ "tasks": tasks }),
        Some(ByRibs::Refused(why)) => fields["computed"] = json!({ "refused": why }),
        None => (),
    }
    if record.config.several_tasks() {
        fields["tasks"] = json!(record.config.tasks);
    }
    fields
}

/// The finger that is the best on the bench; the numbers without `bench` are simulated.
fn on_bench(record: &StudyRecord, found: &OnBench) -> Value {
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
fn bench_json(found: &OnBench) -> Value {
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
