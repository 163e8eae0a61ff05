//! The recommendation of a study as JSON.

use insertion::evaluation::objective::Measure;
use report::answer::{Answer, AsGood, Measured, Recommended, Trust, command, expectation};
use serde_json::{Value, json};
use std::path::Path;
use study::{ByRibs, OnBench, StudyRecord};

/// `recommended`, `equivalent_designs` and `spread_mm`.
pub fn json(answer: &Answer) -> Value {
    let one = answer.recommended.as_ref().filter(|_| answer.front.is_none());
    let simulated = one.filter(|_| answer.verdict.key() != "nothing_inserts");
    let simulated = simulated.map(|found| recommended(answer.record, found));
    let mut fields = match &answer.record.on_bench {
        None => json!({ "recommended": simulated }),
        Some(bench) => json!({
            "recommended": on_bench(answer.record, bench),
            "recommended_by_simulation": simulated,
            "bench": bench_json(bench),
        }),
    };
    let as_good = one.and_then(|found| found.as_good.as_ref());
    let equivalent = as_good.map(|as_good| as_good.designs.len());
    // One decimal, without the noise of the subtraction.
    let spread = answer.spread_mm.map(|[low, high]| ((high - low) * 1e6).round() / 1e6);
    fields["equivalent_designs"] = json!(equivalent);
    fields["spread_mm"] = json!(spread);
    fields
}

/// The answer: what to do, what to expect, how far to trust it.
pub fn answer(answer: &Answer, dir: &Path) -> Value {
    let one = answer.recommended.as_ref().filter(|_| answer.verdict.finger().is_some());
    // Of fingers predicted for a bench the simulated set and window say nothing.
    let one = one.filter(|_| answer.record.on_bench.is_none());
    let as_good = one.and_then(|found| found.as_good.as_ref());
    let (command, why) = command::next(answer, dir);
    json!({
        "verdict": answer.verdict.key(),
        "headline": answer.verdict.headline(),
        "expectation": expectation(answer),
        "finger": answer.verdict.finger(),
        "trust": trust(&answer.trust),
        "start": one.and_then(|found| found.start).map(|start| json!({
            "negative_mm": start.window_mm[0],
            "positive_mm": start.window_mm[1],
            "one_sided": start.one_sided(),
            "to_middle_mm": start.to_middle_mm,
            "advice": start.advice(),
        })),
        "as_good": as_good.map(|as_good| set(answer, as_good)),
        "next": { "command": command, "why": why },
    })
}

fn trust(trust: &Trust) -> Value {
    let mut fields = json!({
        "level": trust.key(),
        "label": trust.label(),
        "reason": trust.reason(),
    });
    match trust {
        Trust::Calibrated { fingers, error_percent } => {
            fields["measured"] = json!(fingers);
            fields["loo_mean_deviation_percent"] = json!(error_percent);
        }
        Trust::Published { nearest, .. } => {
            let one = |task: &str, finger: &Measured| json!({ "task": task, "values": finger.design, "range_mm": finger.range_mm });
            let all =
                nearest.iter().flat_map(|(task, fingers)| fingers.iter().map(move |f| (task, f)));
            fields["nearest_measured"] = all.map(|(task, finger)| one(task, finger)).collect();
        }
        Trust::Simulated { error_percent } => {
            fields["error_percent_on_shipped_tasks"] = json!(error_percent);
        }
    }
    fields
}

fn set(answer: &Answer, as_good: &AsGood) -> Value {
    let in_mm = answer.record.config.objective.first().unit() == "mm";
    let spread = as_good.spread.iter().map(|spread| (spread.key.to_owned(), json!(spread.values)));
    json!({
        "within_mm": answer.record.config.indifference_mm,
        "designs": as_good.designs.len(),
        "of": answer.designs,
        "share_of_space": as_good.share,
        "evaluations": as_good.designs.iter().map(|(found, _)| found.index).collect::<Vec<_>>(),
        "spread": spread.collect::<serde_json::Map<_, _>>(),
        "safe": as_good.safe.as_ref().map(|safe| json!({
            "values": safe.design.design,
            "evaluation": safe.design.index,
            "measured_range_mm": safe.measured_mm,
            "peak_force_n": safe.force_n,
            // What is not in mm is as good only where it loses nothing.
            "loss_mm": in_mm.then_some(safe.loss),
        })),
    })
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
