//! The answer of a study as a card: what the recommended design tolerates, how firm that is, what
//! ends it, what is as good, and how much the choice matters.

use super::text::outcome;
use crate::calibration::order::{Order, order_on_bench};
use crate::study::{ByRibs, Recommendation, Recorded, StudyRecord};
use input::units::N_PER_MM;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::robustness::firm::{Firm, REPEATS};
use insertion::evaluation::{Evaluation, Window, grid_mm};
use insertion::outcome::Outcome;
use maud::{Markup, html};

/// A number to be seen at a glance: its name, itself, and what is to be known of it.
struct Figure {
    name: String,
    value: String,
    note: String,
}

/// The card of the recommended design.
pub(super) fn card(record: &StudyRecord, best: &Recorded) -> Markup {
    let found = record.recommendation();
    html! {
        div.card {
            dl.figures {
                @for Figure { name, value, note } in figures(record, best, found.as_ref()) {
                    div { dt { (name) } dd { b { (value) } } dd.muted { (note) } }
                }
            }
            @for line in found.iter().flat_map(|found| as_good(record, found)) { p { (line) } }
            @if let Some([low, high]) = record.spread_mm() {
                p {
                    (format!("Over the {} designs the range goes from {low:.1} to {high:.1} mm.", record.current().len()))
                }
            }
            @if let Some(widest) = wider(record, best) { p { (widest) } }
            @for line in bench(record) { p { (line) } }
            p {
                a href="evaluations.csv" { "table of all evaluations" } ", "
                a href="journal.jsonl" { "journal" } ", "
                a href="convergence.svg" { "convergence" }
            }
        }
    }
}

fn figures(record: &StudyRecord, best: &Recorded, found: Option<&Recommendation>) -> Vec<Figure> {
    let mut figures = Vec::new();
    let firm = found.and_then(|found| found.firm.as_ref().map(|firm| (found, firm)));
    if let Some((ranges, firm)) =
        firm.and_then(|(found, firm)| Some((found.firm_ranges_mm()?, firm)))
    {
        figures.push(Figure {
            name: "firm range".to_owned(),
            value: format!("{:.1} mm", record.aggregated(Measure::Range, &ranges)),
            note: format!(
                "{}inserts in {REPEATS} of {REPEATS} repeats with friction, start and step varied",
                firm_window(firm)
            ),
        });
    }
    for (task, evaluation) in record.config.tasks().zip(best.tasks()) {
        let on = if record.config.several_tasks() { format!(" on {task}") } else { String::new() };
        let window = &evaluation.window;
        figures.push(Figure {
            name: format!("range{on}"),
            value: format!("{:.1} mm", window.range_mm()),
            note: format!(
                "{:+.1} to {:+.1} mm: {}",
                window.negative_mm(),
                window.positive_mm(),
                ends(window)
            ),
        });
        if let Some(force) = Measure::PeakForce.value(evaluation) {
            figures.push(Figure {
                name: format!("peak force{on}"),
                value: format!("{force:.0} N"),
                note: "between plug and socket, over the inserted trials".to_owned(),
            });
        }
    }
    figures.extend(found.and_then(|found| found.by_ribs).map(|found| by_ribs(record, found)));
    let stiffness = &best.stiffness;
    let source = if stiffness.inside_hull() { "interpolated between" } else { "extrapolated from" };
    figures.push(Figure {
        name: "stiffness of one finger".to_owned(),
        value: format!("{:.1} N/mm", stiffness.compliance.mean / N_PER_MM),
        note: format!(
            "across the insertion, {:.0} N/mm along it; {source} the measured designs",
            stiffness.assembly.mean / N_PER_MM
        ),
    });
    figures
}

/// What springs computed from its ribs make of the finger, beside those of the paper.
fn by_ribs(record: &StudyRecord, found: &ByRibs) -> Figure {
    let name = "range with springs from its ribs".to_owned();
    let tasks = match found {
        ByRibs::Refused(why) => {
            return Figure { name, value: "none".to_owned(), note: why.clone() };
        }
        ByRibs::Measured(tasks) => tasks,
    };
    let ranges: Vec<f64> = tasks.iter().map(|task| task.window.range_mm()).collect();
    let window = |task: &Evaluation| {
        let (low, high) = (task.window.negative_mm(), task.window.positive_mm());
        let start = task
            .taught
            .map_or(String::new(), |by| format!(", start taught {:+.1} mm", grid_mm(by)));
        format!("{low:+.1} to {high:+.1} mm{start}: {}", ends(&task.window))
    };
    let windows: Vec<String> = tasks.iter().map(window).collect();
    Figure {
        name,
        value: format!("{:.1} mm", record.aggregated(Measure::Range, &ranges)),
        note: format!(
            "{}; the ranges beside it have the paper's one remote centre",
            windows.join("; ")
        ),
    }
}

/// Why a wider window than the recommended one's is not recommended.
fn wider(record: &StudyRecord, best: &Recorded) -> Option<String> {
    let by_range = record.config.objective.single() == Some(Measure::Range);
    let (own, [_, widest]) = (record.measure(best, Measure::Range)?, record.spread_mm()?);
    // Half a step of the grid.
    (by_range && !record.walked.is_empty() && widest > own + 0.05).then(|| {
        format!("The widest window, {widest:.1} mm by the first search, was less firm when measured again.")
    })
}

/// What is known of how the bench orders fingers, task by task.
fn bench(record: &StudyRecord) -> Vec<String> {
    let known = |(at, task): (usize, &str)| {
        let order = order_on_bench(record, at)?;
        let advice = if beyond_chance(&order) { "" } else { ", no more than chance gives" };
        Some(format!(
            "On {task} {} ranked {} printed fingers with a correlation of {:+.2} to the bench{advice} (1: the same order).",
            order.source.words(),
            order.fingers,
            order.spearman,
        ))
    };
    let mut lines: Vec<String> = record.config.tasks().enumerate().filter_map(known).collect();
    if lines.is_empty() {
        lines.push("How the bench orders fingers on this task is not known.".to_owned());
    }
    lines.push("Print and measure more than one: optimize next says which.".to_owned());
    lines
}

/// Whether a random order would do as well in less than 5 % of cases: of `n` fingers its rank correlation has
/// mean 0 and variance 1 / (n - 1), taken as normal.
pub fn beyond_chance(order: &Order) -> bool {
    order.spearman * (order.fingers as f64 - 1.0).sqrt() > 1.645
}

/// The firm window of a study of one task.
fn firm_window(firm: &[Firm]) -> String {
    match firm {
        [one] => one
            .window_mm()
            .map_or(String::new(), |[low, high]| format!("{low:+.1} to {high:+.1} mm: ")),
        _ => String::new(),
    }
}

fn ends(window: &Window) -> String {
    let end = |end: Option<Outcome>| end.map_or("no failure".to_owned(), outcome);
    format!("{} below, {} above", end(window.end_negative), end(window.end_positive))
}

/// How many designs are as good, and which of them to take for other reasons.
fn as_good(record: &StudyRecord, found: &Recommendation) -> Vec<String> {
    let (count, of) = (found.equivalent.len(), record.current().len());
    if count < 2 {
        return vec![format!("No other of {of} designs is as good.")];
    }
    let mut lines = vec![format!("{count} of {of} designs are equivalent: choose by other needs.")];
    let force = |r: &Recorded| record.measure(r, Measure::PeakForce).unwrap_or(f64::INFINITY);
    let compliance = |r: &Recorded| r.stiffness.compliance.mean / N_PER_MM;
    let designs = || found.equivalent.iter();
    for (name, found, unit) in [
        ("Least force", designs().map(|r| (force(r), r)).min_by(|a, b| a.0.total_cmp(&b.0)), "N"),
        (
            "Softest",
            designs().map(|r| (compliance(r), r)).min_by(|a, b| a.0.total_cmp(&b.0)),
            "N/mm",
        ),
        (
            "Stiffest",
            designs().map(|r| (compliance(r), r)).max_by(|a, b| a.0.total_cmp(&b.0)),
            "N/mm",
        ),
    ] {
        if let Some((value, recorded)) = found.filter(|(value, _)| value.is_finite()) {
            let design = recorded.design.labelled();
            lines.push(format!(
                "{name}: {design}, {value:.1} {unit} (evaluation {}).",
                recorded.index
            ));
        }
    }
    lines
}
