//! Results of both engines as text and as JSON.

use super::{AGREEMENT, CrossCheck, END_DIFFERENCE_MM, TrialPair};
use crate::compare::{pairs, subject_json};
use insertion::evaluation::grid_mm;
use insertion::outcome::Outcome;
use serde_json::{Value, json};
use std::fmt::Write;

/// Tables and totals; `names` are those of the engines.
pub fn text(check: &CrossCheck, names: [&str; 2]) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "T9: the same trials in {} and {}\n", names[0], names[1]);
    windows(&mut text, check);
    counts(&mut text, check);
    disagreements(&mut text, check, names);
    text
}

fn windows(text: &mut String, check: &CrossCheck) {
    let Some(mean) = check.end_difference_mm() else { return };
    text.push_str(&pairs::text(&check.windows, None));
    let verdict = verdict(mean <= END_DIFFERENCE_MM);
    let words = "mean difference of an end";
    let _ = writeln!(text, "{words} {mean:.2} mm; target {END_DIFFERENCE_MM} mm: {verdict}\n");
}

fn verdict(met: bool) -> &'static str {
    if met { "met" } else { "MISSED" }
}

fn counts(text: &mut String, check: &CrossCheck) {
    let agreed = check.trials.iter().filter(|pair| pair.agrees()).count();
    let total = check.trials.len();
    let verdict = verdict(check.agreement() >= AGREEMENT);
    let [share, target] = [check.agreement(), AGREEMENT].map(|share| 100.0 * share);
    let _ = writeln!(
        text,
        "alike in {agreed} of {total} trials, {share:.1} %; target {target:.0} %: {verdict}"
    );
    let mut tips: Vec<f64> = check.trials.iter().filter_map(|pair| pair.tip_mm).collect();
    tips.sort_by(f64::total_cmp);
    let count = tips.len();
    if let (Some(median), Some(largest)) = (tips.get(count / 2), tips.last()) {
        let _ = writeln!(
            text,
            "tips of the {count} plugs that both insert: {median:.3} mm apart (median), {largest:.3} mm at most"
        );
    }
}

fn disagreements(text: &mut String, check: &CrossCheck, [first, second]: [&str; 2]) {
    let others: Vec<&TrialPair> = check.trials.iter().filter(|pair| !pair.agrees()).collect();
    if others.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "\n{:<7}{:<13}{:>10}{:>15}  {first:<27}{second}",
        "task", "finger", "offset mm", "beyond end mm"
    );
    for pair in others {
        let [a, b] = pair.outcomes.map(Outcome::label);
        let (task, infill) = (&pair.subject.task, pair.subject.infill());
        let [offset, beyond] = [pair.offset, pair.from_end].map(grid_mm);
        let _ = writeln!(text, "{task:<7}{infill:<13}{offset:>10.1}{beyond:>15.1}  {a:<27}{b}");
    }
}

/// Results as JSON, lengths in mm.
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
    let windows = pairs::json(&check.windows, None, "engine", ["first", "second"]);
    json!({
        "engines": names,
        "agreement": check.agreement(),
        "agreement_target": AGREEMENT,
        "end_difference_mm": check.end_difference_mm(),
        "end_difference_target_mm": END_DIFFERENCE_MM,
        "passed": check.passed(),
        "trials": check.trials.iter().map(trial).collect::<Vec<_>>(),
        "windows": windows,
    })
}
