//! What the two engines made of the set, as text and as JSON.

use super::{AGREEMENT, Case, CrossCheck, END_DIFFERENCE_MM};
use crate::evaluation::{Window, grid_mm};
use crate::outcome::Outcome;
use serde_json::{Value, json};
use std::fmt::Write;

/// Tables and totals; `names` are the engines'.
pub fn text(check: &CrossCheck, names: [&str; 2]) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "T9: the same trials in {} and {}\n", names[0], names[1]);
    windows(&mut text, check, names);
    counts(&mut text, check);
    disagreements(&mut text, check, names);
    text
}

fn windows(text: &mut String, check: &CrossCheck, [first, second]: [&str; 2]) {
    if check.windows.is_empty() {
        return;
    }
    let header = [format!("{first}, mm"), format!("{second}, mm")];
    let _ = writeln!(
        text,
        "{:<7}{:<13}{:<20}{:<20}differences, mm",
        "task", "finger", header[0], header[1]
    );
    for pair in &check.windows {
        let [a, b] = pair.windows.each_ref().map(window_words);
        let [low, high] = pair.differences_mm();
        let _ =
            writeln!(text, "{:<7}{:<13}{a:<20}{b:<20}{low:+.1} {high:+.1}", pair.task, pair.finger);
    }
    if let Some(mean) = check.end_difference_mm() {
        let verdict = if mean <= END_DIFFERENCE_MM { "met" } else { "MISSED" };
        let _ = writeln!(
            text,
            "mean difference of an end {mean:.2} mm; target {END_DIFFERENCE_MM} mm: {verdict}\n"
        );
    }
}

fn counts(text: &mut String, check: &CrossCheck) {
    let agreed = check.cases.iter().filter(|case| case.agrees()).count();
    let total = check.cases.len();
    let verdict = if check.agreement() >= AGREEMENT { "met" } else { "MISSED" };
    let _ = writeln!(
        text,
        "inserted or failed alike in {agreed} of {total} trials, {:.1} %; target {:.0} %: {verdict}",
        100.0 * check.agreement(),
        100.0 * AGREEMENT,
    );
    let mut tips: Vec<f64> = check.cases.iter().filter_map(|case| case.tip_mm).collect();
    tips.sort_by(f64::total_cmp);
    if let (Some(median), Some(largest)) = (tips.get(tips.len() / 2), tips.last()) {
        let _ = writeln!(
            text,
            "tips of the {} plugs inserted by both: apart by {median:.3} mm (median), {largest:.3} mm (largest)",
            tips.len()
        );
    }
}

fn disagreements(text: &mut String, check: &CrossCheck, [first, second]: [&str; 2]) {
    let others: Vec<&Case> = check.cases.iter().filter(|case| !case.agrees()).collect();
    if others.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "\n{:<7}{:<13}{:>10}{:>15}  {first:<27}{second}",
        "task", "finger", "offset mm", "beyond end mm"
    );
    for case in others {
        let [a, b] = case.outcomes.map(word);
        let _ = writeln!(
            text,
            "{:<7}{:<13}{:>10.1}{:>15.1}  {a:<27}{b}",
            case.task,
            case.finger,
            grid_mm(case.offset),
            grid_mm(case.from_end)
        );
    }
}

fn window_words(window: &Window) -> String {
    if window.nominal != Outcome::Inserted {
        return "none".to_owned();
    }
    format!("{:+.1} to {:+.1}", window.negative_mm(), window.positive_mm())
}

fn word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Inserted => "inserted",
        Outcome::Failed(class) => class.label(),
        Outcome::Diverged => "diverged",
    }
}

/// The same for programs; lengths in mm.
pub fn json(check: &CrossCheck, names: [&str; 2]) -> Value {
    let case = |case: &Case| {
        json!({
            "task": case.task,
            "finger": case.finger,
            "offset_mm": grid_mm(case.offset),
            "beyond_end_mm": grid_mm(case.from_end),
            "outcomes": case.outcomes.map(word),
            "agrees": case.agrees(),
            "tip_distance_mm": case.tip_mm,
        })
    };
    json!({
        "engines": names,
        "agreement": check.agreement(),
        "agreement_target": AGREEMENT,
        "end_difference_mm": check.end_difference_mm(),
        "end_difference_target_mm": END_DIFFERENCE_MM,
        "passed": check.passed(),
        "trials": check.cases.iter().map(case).collect::<Vec<_>>(),
        "windows": check.windows.iter().map(|pair| json!({
            "task": pair.task,
            "finger": pair.finger,
            "windows_mm": pair.windows.each_ref().map(|w| [w.negative_mm(), w.positive_mm()]),
            "inserts": pair.windows.each_ref().map(|w| w.nominal == Outcome::Inserted),
        })).collect::<Vec<_>>(),
    })
}
