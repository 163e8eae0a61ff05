//! Recommendation and answer of a study as JSON.

use insertion::{Measure, Objectives};
use report::answer::{Answer, LeftOut, Ties, Trust, Verdict, command, expectation, lines};
use serde_json::{Map, Value, json};
use std::path::Path;
use study::{BenchPrediction, ByRibs, StudyRecord};

/// Returns the recommended design, with measurements the one predicted to be the best on the bench, and
/// the number of equivalent designs.
pub fn recommendation(answer: &Answer) -> Value {
    let mut keys = match &answer.record.on_bench {
        None => json!({"recommended": simulated(answer)}),
        Some(found) => json!({
            "recommended": on_bench(answer.record, found),
            "recommended_by_simulation": simulated(answer),
            "bench": bench(found),
        }),
    };
    let one = answer.recommended.as_ref().filter(|_| answer.front.is_none());
    let as_good = one.and_then(|found| found.ties.as_ref());
    keys["equivalent_designs"] = json!(as_good.map(|as_good| as_good.designs.len()));
    // Without the rounding error of the subtraction.
    let spread = answer.spread_mm.map(|[low, high]| ((high - low) * 1e6).round() / 1e6);
    keys["spread_mm"] = json!(spread);
    keys
}

/// Returns the recommended design, or the first of a front; null if there is none.
pub fn best(answer: &Answer) -> Value {
    let first = || {
        let first = answer.front.as_ref()?.designs.first()?;
        let score = first.score.iter().flat_map(|score| score.values.iter().copied());
        let objectives = values(&answer.record.config.objective, score);
        Some(json!({
            "values": first.design,
            "evaluation": first.index,
            "objectives": objectives,
        }))
    };
    match recommendation(answer)["recommended"].take() {
        Value::Null => first().unwrap_or_default(),
        found => found,
    }
}

/// Returns values by the keys of their objectives.
pub(super) fn values(
    objectives: &Objectives,
    values: impl IntoIterator<Item = f64>,
) -> Map<String, Value> {
    objectives.keys().into_iter().zip(values.into_iter().map(Value::from)).collect()
}

/// Returns the design recommended by simulation.
fn simulated(answer: &Answer) -> Value {
    let found = answer.recommended.as_ref().filter(|_| answer.front.is_none());
    let inserts = !matches!(answer.verdict, Verdict::NothingInserts { .. });
    let Some(found) = found.filter(|_| inserts) else {
        return Value::Null;
    };
    let [negative, positive] = [0, 1].map(|end| found.range_mm.map(|_| found.window_mm[end]));
    let firm = [0, 1].map(|end| found.firm_window_mm.map(|window| window[end]));
    let mut json = json!({
        "values": found.design.design,
        "evaluation": found.design.index,
        "firm_range_mm": found.firm_range_mm,
        "range_mm": found.range_mm,
        "negative_mm": negative,
        "positive_mm": positive,
        "firm_negative_mm": firm[0],
        "firm_positive_mm": firm[1],
        "peak_force_n": answer.record.measure(found.design, Measure::PeakForce),
    });
    match found.by_ribs {
        Some(ByRibs::Measured(tasks)) => json["computed"] = json!({"tasks": tasks}),
        Some(ByRibs::Refused(reason)) => json["computed"] = json!({"refused": reason}),
        None => {}
    }
    if answer.record.config.several_tasks() {
        json["tasks"] = json!(answer.record.config.tasks);
    }
    json
}

/// Returns the finger that is predicted to be the best on the bench; values outside the key `bench` are simulated.
fn on_bench(record: &StudyRecord, found: &BenchPrediction) -> Value {
    let Some(best) = found.best.first() else { return Value::Null };
    let evaluated = record.current().iter().find(|recorded| recorded.design == best.design);
    let (range, window) = (Measure::Range.value(&found.simulated), &found.simulated.window);
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

/// Returns effort and validation of a prediction for the bench.
fn bench(found: &BenchPrediction) -> Value {
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

/// Returns the answer of the study in `dir`: recommended action, expectation and trust.
pub fn advice(answer: &Answer, dir: &Path) -> Value {
    // The simulated ties and window do not apply to a finger that is predicted for the bench.
    let simulated = answer.verdict.finger().is_some() && answer.record.on_bench.is_none();
    let one = answer.recommended.as_ref().filter(|_| simulated);
    let as_good = one.and_then(|found| found.ties.as_ref());
    let (command, why) = command::next(answer, dir);
    json!({
        "verdict": answer.verdict_key(),
        "headline": answer.headline(),
        "expectation": expectation(answer),
        "use_now": answer.use_now(),
        "finger": answer.verdict.finger(),
        "force": force(answer),
        "left_out": left_out(answer),
        "trust": trust(&answer.trust),
        "rank_correlations": answer.rank_correlations,
        "start": one.and_then(|found| found.start.as_ref()),
        "as_good": as_good.map(|as_good| equivalent(answer, as_good)),
        "next": {"command": command, "why": why.to_string()},
    })
}

/// Returns the contact force that exceeds a limit of the connector or the robot, and the remedy; null if there is
/// none.
fn force(answer: &Answer) -> Value {
    let (Some(excess), Some((_, text))) = (&answer.force, lines::force(answer)) else {
        return Value::Null;
    };
    let mut json = json!(excess);
    json["warning"] = text.into();
    json
}

/// Returns the best design, in whose place a tied one is recommended; null if there is none.
fn left_out(answer: &Answer) -> Value {
    let (Some(left_out), Some((_, text))) = (&answer.left_out, lines::left_out(answer)) else {
        return Value::Null;
    };
    let LeftOut { design, force, .. } = left_out;
    json!({
        "values": design.design,
        "evaluation": design.index,
        "peak_force_n": force.peak_force_n,
        "limit_n": force.limit_n,
        "sentence": text,
    })
}

fn trust(trust: &Trust) -> Value {
    let mut json = json!({
        "level": trust.key(),
        "label": trust.label().to_string(),
        "reason": trust.reason().to_string(),
    });
    match trust {
        Trust::Calibrated { fingers, error_percent } => {
            json["measured"] = json!(fingers);
            json["loo_mean_deviation_percent"] = json!(error_percent);
        }
        Trust::Published { nearest } => {
            let of_task = nearest.iter().flat_map(|(task, fingers)| {
                fingers.iter().map(move |(finger, range_mm)| {
                    json!({"task": task, "values": finger, "range_mm": range_mm})
                })
            });
            json["nearest_measured"] = of_task.collect();
        }
        Trust::Simulated { error_percent } => {
            json["error_percent_on_shipped_tasks"] = json!(error_percent);
        }
    }
    json
}

/// Returns the designs that are equivalent to the recommended one.
fn equivalent(answer: &Answer, as_good: &Ties) -> Value {
    let in_mm = answer.record.config.objective.first().unit() == "mm";
    let spread = as_good.spread.iter();
    let spread: Map<_, _> = spread.map(|s| (s.key.to_owned(), s.values.to_vec().into())).collect();
    let evaluations: Vec<u64> = as_good.designs.iter().map(|(found, _)| found.index).collect();
    let safe = as_good.safe.as_ref().map(|safe| {
        json!({
            "values": safe.design.design,
            "evaluation": safe.design.index,
            "measured_range_mm": safe.measured_mm,
            "peak_force_n": safe.force_n,
            // With objectives in other units only designs without a loss are equivalent.
            "loss_mm": in_mm.then_some(safe.loss),
        })
    });
    json!({
        "within_mm": answer.record.config.indifference_mm,
        "sentence": lines::tied(answer, as_good).1,
        "designs": as_good.designs.len(),
        "of": answer.designs,
        "share_of_space": as_good.share,
        "evaluations": evaluations,
        "spread": spread,
        "safe": safe,
    })
}
