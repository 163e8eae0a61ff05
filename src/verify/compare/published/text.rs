//! The tables and the summary of a task as text, within 100 columns.

use super::{DesignRow, Reading, TaskTable, targets};
use crate::evaluation::Window;
use crate::outcome::Outcome;
use crate::units::N_PER_MM;
use std::fmt::Write;

/// A task's designs, the agreement of the sources, and the targets.
pub fn text(table: &TaskTable) -> String {
    let mut text = format!(
        "{}\n{:>6} {:>8} {:>10} {:>11}   {:<27} {:<15} {}\n",
        table.task,
        "design",
        "infill",
        "compliance",
        "assembly",
        "ours: window, range, ends",
        "published sim.",
        "bench"
    );
    for row in &table.rows {
        text.push_str(&design(row));
    }
    let _ = writeln!(
        text,
        "\n  {:<42}{:>8}{:>11}{:>10}{:>11}{:>10}",
        "compared", "designs", "mean |e|", "mean e", "deviation", "Spearman"
    );
    for found in table.agreements() {
        let compared = format!("{} - {}", found.source.label(), found.reference.label());
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "  {compared:<42}{:>8}{:>11}{:>10}{:>11}{:>10}",
            found.designs,
            value(found.mean_absolute_error_mm, |v| format!("{v:.2} mm")),
            value(found.mean_error_mm, |v| format!("{v:+.2} mm")),
            value(found.mean_deviation_percent, |v| format!("{v:.1} %")),
            value(found.spearman, |v| format!("{v:+.2}")),
        );
        let percent = value(found.match_percent(), |v| format!("{v:.1} %"));
        let (matched, ends) = (found.matched_ends, found.ends);
        let _ = writeln!(text, "    failures matched at {matched} of {ends} ends: {percent}");
    }
    text.push('\n');
    for target in targets(table) {
        let bound = if target.at_most { "at most" } else { "at least" };
        let verdict = if target.met() { "met" } else { "MISSED" };
        let found = value(target.found, |v| short(v, target.unit));
        let asked = format!("{bound} {}", short(target.limit, target.unit));
        let quantity = target.quantity;
        let _ = writeln!(text, "  target: {quantity:<34}{found:>9}   {asked:<18}{verdict}");
    }
    text
}

fn design(row: &DesignRow) -> String {
    let m = &row.design;
    format!(
        "{:>6} {:>4} % {:>2}° {:>5} N/mm {:>6} N/mm   {:<27} {:<15} {}\n",
        m.design,
        m.density_percent,
        m.direction_deg,
        format!("{:.2}", m.compliance / N_PER_MM),
        format!("{:.1}", m.assembly / N_PER_MM),
        ours(&row.window),
        row.simulation.map_or(String::new(), reading),
        row.bench.map_or(String::new(), reading),
    )
}

/// `-4.2 +3.1  7.3 mm  4 | 3`.
fn ours(window: &Window) -> String {
    if window.nominal != Outcome::Inserted {
        return format!("none: nominal start {}", end(Some(window.nominal)));
    }
    let ends = format!("{} | {}", end(window.end_negative), end(window.end_positive));
    let (negative, positive) = (window.negative_mm(), window.positive_mm());
    format!("{negative:>5.1} {positive:>+5.1} {:>4.1} mm {ends}", window.range_mm())
}

/// The class; `x` for a divergence, `-` for no failure.
fn end(outcome: Option<Outcome>) -> String {
    match outcome {
        Some(Outcome::Failed(class)) => class.number().to_string(),
        Some(Outcome::Diverged) => "x".to_owned(),
        Some(Outcome::Inserted) | None => "-".to_owned(),
    }
}

fn reading(reading: Reading) -> String {
    let range = value(reading.range_mm, |v| format!("{v:.1} mm"));
    let [negative, positive] =
        reading.failures.map(|class| class.map_or("-".to_owned(), |c| c.number().to_string()));
    format!("{range:>6} {negative} | {positive}")
}

fn value(value: Option<f64>, format: impl Fn(f64) -> String) -> String {
    value.map_or("-".to_owned(), format)
}

/// A number with as many digits as its unit needs.
fn short(value: f64, unit: &str) -> String {
    match unit {
        "" if value.fract() == 0.0 => format!("{value:.0}"),
        "" => format!("{value:.2}"),
        "%" => format!("{value:.1} %"),
        unit => format!("{value:.2} {unit}"),
    }
}
