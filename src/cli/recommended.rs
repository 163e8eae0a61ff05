//! The recommendation of a study as JSON.

use super::on_bench;
use crate::answer::{Answer, Recommended};
use crate::study::{ByRibs, StudyRecord};
use serde_json::{Value, json};

/// The [`json()`] of a study's answer.
pub fn to_json(record: &StudyRecord) -> Value {
    json(&Answer::of(record))
}

/// `recommended`, `equivalent_designs` and `spread_mm`.
pub fn json(answer: &Answer) -> Value {
    let one = answer.recommended.as_ref().filter(|_| answer.front.is_none());
    let simulated = one.filter(|_| answer.nothing_inserts.is_none());
    let simulated = simulated.map(|found| recommended(answer.record, found));
    let mut fields = match &answer.record.on_bench {
        None => json!({ "recommended": simulated }),
        Some(bench) => json!({
            "recommended": on_bench::recommended(answer.record, bench),
            "recommended_by_simulation": simulated,
            "bench": on_bench::to_json(bench),
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
