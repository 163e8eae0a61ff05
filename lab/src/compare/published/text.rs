//! Table and summary of a task as text, within 80 columns.

use super::targets::{Limit, targets};
use super::{DesignRow, Reading, TaskTable};
use input::units::N_PER_MM;
use insertion::evaluation::Window;
use insertion::outcome::Outcome;
use insertion::stiffness::Measurement;
use std::fmt::Write;

/// Designs of a task, agreement of the sources, and targets.
pub fn text(table: &TaskTable) -> String {
    let mut text = format!(
        "{}\n\
         no.    infill      y      z  ours: window range ends published sim. bench\n\
         {:16}N/mm   N/mm  mm                      mm             mm\n",
        table.task, ""
    );
    for row in &table.rows {
        text.push_str(&design(row));
    }
    let columns = ["mean |e|", "mean e", "off by", "Spearman"].map(|name| format!("{name:>9}"));
    let _ = writeln!(text, "\n{:<41} of{}", "compared", columns.concat());
    for found in table.agreements() {
        let compared = format!("{} - {}", found.source.names()[0], found.reference.names()[0]);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{compared:<41}{:>3}{:>9}{:>9}{:>9}{:>9}",
            found.designs,
            value(found.mean_absolute_error_mm, |v| format!("{v:.2} mm")),
            value(found.mean_error_mm, |v| format!("{v:+.2} mm")),
            value(found.mean_deviation_percent, |v| format!("{v:.1} %")),
            value(found.spearman, |v| format!("{v:+.2}")),
        );
        let percent = value(found.match_percent, |v| format!("{v:.1} %"));
        let (matched, ends) = (found.matched_ends, found.ends);
        let _ = writeln!(text, "  failures matched at {matched} of {ends} ends: {percent}");
    }
    text.push('\n');
    for target in targets(table) {
        let bound = if target.limit_is == Limit::Largest { "at most" } else { "at least" };
        let verdict = if target.met { "met" } else { "MISSED" };
        let found = value(target.found, |v| short(v, target.unit));
        let asked = format!("{bound} {}", short(target.limit, target.unit));
        let quantity = target.quantity;
        let _ = writeln!(text, "  target: {quantity:<34}{found:>9}   {asked:<18}{verdict}");
    }
    text
}

fn design(row: &DesignRow) -> String {
    let Measurement { design, density_percent, direction_deg, .. } = row.design;
    let [y, z] = [row.design.compliance, row.design.assembly].map(|k| k / N_PER_MM);
    let ours = ours(&row.window);
    let [simulation, bench] = [row.simulation, row.bench].map(|r| r.map_or(String::new(), reading));
    format!(
        "{design:>3} {density_percent:>4} % {direction_deg:>2}°{y:>7.2}{z:>7.1}  {ours:<23} {simulation:<14} {bench}\n"
    )
}

/// Window as in `-4.2 +3.1  7.3  4 | 3`.
fn ours(window: &Window) -> String {
    if window.nominal != Outcome::Inserted {
        return format!("none: nominal start {}", end(Some(window.nominal)));
    }
    let ends = format!("{} | {}", end(window.end_negative), end(window.end_positive));
    let (negative, positive) = (window.negative_mm(), window.positive_mm());
    format!("{negative:>5.1} {positive:>+5.1} {:>4.1}  {ends}", window.range_mm())
}

/// Number of the failure class; `x` for a divergence, `-` for no failure.
fn end(outcome: Option<Outcome>) -> String {
    match outcome {
        Some(Outcome::Failed(class)) => class.number().to_string(),
        Some(Outcome::Diverged) => "x".to_owned(),
        Some(Outcome::Inserted) | None => "-".to_owned(),
    }
}

fn reading(reading: Reading) -> String {
    let range = value(reading.range_mm, |v| format!("{v:.1}"));
    let [negative, positive] =
        reading.failures.map(|class| class.map_or("-".to_owned(), |c| c.number().to_string()));
    format!("{range:>4}  {negative} | {positive}")
}

fn value(value: Option<f64>, format: impl Fn(f64) -> String) -> String {
    value.map_or("-".to_owned(), format)
}

/// Number with as many digits as its unit needs.
fn short(value: f64, unit: &str) -> String {
    match unit {
        "" if value.fract() == 0.0 => format!("{value:.0}"),
        "" => format!("{value:.2}"),
        "%" => format!("{value:.1} %"),
        unit => format!("{value:.2} {unit}"),
    }
}
