//! Results of both engines as text and as JSON.

use super::{AGREEMENT, CrossCheck, END_DIFFERENCE_MM, TrialPair};
use crate::compare::{pairs, subject_json};
use insertion::evaluation::grid_mm;
use insertion::outcome::Outcome;
use serde_json::{Value, json};

/// Tables and totals; `names` are those of the engines.
pub fn text(check: &CrossCheck, [first, second]: [&str; 2]) -> String {
    let verdict = |met| if met { "met" } else { "MISSED" };
    let mut text = format!("T9: the same trials in {first} and {second}\n\n");
    if let Some(mean) = check.end_difference_mm() {
        text += &pairs::text(&check.windows, None);
        text += &format!(
            "mean difference of an end {mean:.2} mm; target {END_DIFFERENCE_MM} mm: {}\n\n",
            verdict(mean <= END_DIFFERENCE_MM)
        );
    }
    let others: Vec<&TrialPair> = check.trials.iter().filter(|pair| !pair.agrees()).collect();
    let total = check.trials.len();
    let [share, target] = [check.agreement(), AGREEMENT].map(|share| 100.0 * share);
    text += &format!(
        "alike in {} of {total} trials, {share:.1} %; target {target:.0} %: {}\n",
        total - others.len(),
        verdict(check.agreement() >= AGREEMENT)
    );
    let mut tips: Vec<f64> = check.trials.iter().filter_map(|pair| pair.tip_mm).collect();
    tips.sort_by(f64::total_cmp);
    let count = tips.len();
    if let (Some(median), Some(largest)) = (tips.get(count / 2), tips.last()) {
        text += &format!(
            "tips of the {count} plugs that both insert: {median:.3} mm apart (median), {largest:.3} mm at most\n"
        );
    }
    if !others.is_empty() {
        text += &format!(
            "\n{:<7}{:<13}{:>10}{:>15}  {first:<27}{second}\n",
            "task", "finger", "offset mm", "beyond end mm"
        );
    }
    for pair in others {
        let [a, b] = pair.outcomes.map(Outcome::label);
        let (task, infill) = (&pair.subject.task, pair.subject.infill());
        let [offset, beyond] = [pair.offset, pair.from_end].map(grid_mm);
        text += &format!("{task:<7}{infill:<13}{offset:>10.1}{beyond:>15.1}  {a:<27}{b}\n");
    }
    text
}

pub fn json(check: &CrossCheck, names: [&str; 2]) -> Value {
    let trial = |pair: &TrialPair| {
        let measured = json!({
            "finger": pair.subject.infill(),
            "offset_mm": grid_mm(pair.offset),
            "beyond_end_mm": grid_mm(pair.from_end),
            "outcomes": pair.outcomes.map(Outcome::label),
            "agrees": pair.agrees(),
            "tip_distance_mm": pair.tip_mm,
        });
        subject_json(&pair.subject.task, &pair.subject.design, measured)
    };
    json!({
        "engines": names,
        "agreement": check.agreement(),
        "agreement_target": AGREEMENT,
        "end_difference_mm": check.end_difference_mm(),
        "end_difference_target_mm": END_DIFFERENCE_MM,
        "passed": check.passed(),
        "trials": check.trials.iter().map(trial).collect::<Vec<_>>(),
        "windows": pairs::json(&check.windows, None, "engine", ["first", "second"]),
    })
}
