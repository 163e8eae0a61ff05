//! The answer of a study as a card: what the recommended design tolerates, how firm that is, what
//! ends it, what is as good, and how much the choice matters.

use crate::answer::words::{end, ends_mm, interval, mm, span, taught};
use crate::answer::{Alternative, Answer, AsGood, OnTask, Recommended, TaskOrder};
use crate::study::ByRibs;
use input::units::N_PER_MM;
use insertion::evaluation::robustness::firm::REPEATS;
use insertion::evaluation::{Evaluation, Window};
use maud::{Markup, html};

/// A number to be seen at a glance: its name, itself, and what is to be known of it.
struct Figure {
    name: String,
    value: String,
    note: String,
}

/// The card of the recommended design.
pub(super) fn card(answer: &Answer, found: &Recommended) -> Markup {
    html! {
        div.card {
            dl.figures {
                @for Figure { name, value, note } in figures(found) {
                    div { dt { (name) } dd { b { (value) } } dd.muted { (note) } }
                }
            }
            @for line in lines(answer, found) { p { (line) } }
            p {
                a href="evaluations.csv" { "table of all evaluations" } ", "
                a href="journal.jsonl" { "journal" } ", "
                a href="convergence.svg" { "convergence" }
            }
        }
    }
}

/// What is behind the figures, a paragraph each.
fn lines(answer: &Answer, found: &Recommended) -> Vec<String> {
    let as_good = found.as_good.iter().flat_map(|as_good| equivalent(as_good, answer.designs));
    let mut lines: Vec<String> = as_good.collect();
    lines.extend(answer.spread_mm.map(|spread| {
        format!("Over the {} designs the range goes from {}.", answer.designs, interval(spread))
    }));
    lines.extend(found.wider_mm.map(|widest| {
        let widest = mm(widest);
        format!(
            "The widest window, {widest} by the first search, was less firm when measured again."
        )
    }));
    lines.extend(answer.orders.iter().map(order));
    if answer.orders.is_empty() {
        lines.push("How the bench orders fingers on this task is not known.".to_owned());
    }
    lines.push("Print and measure more than one: optimize next says which.".to_owned());
    lines
}

fn figures(found: &Recommended) -> Vec<Figure> {
    let firm = found.firm_range_mm.map(|range| {
        let window = found.firm_window_mm.filter(|_| found.tasks.len() == 1);
        let window = window.map_or(String::new(), |window| format!("{} mm: ", span(window)));
        Figure {
            name: "firm range".to_owned(),
            value: mm(range),
            note: format!(
                "{window}inserts in {REPEATS} of {REPEATS} repeats with friction, start and step varied"
            ),
        }
    });
    let mut figures: Vec<Figure> = firm.into_iter().collect();
    for task in &found.tasks {
        figures.extend(of_task(task, found.on(task)));
    }
    figures.extend(found.by_ribs.map(|by_ribs| with_ribs(by_ribs, found.by_ribs_range_mm)));
    let stiffness = &found.design.stiffness;
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

/// Range and force; `on` names the task where there are several.
fn of_task(task: &OnTask, on: String) -> impl Iterator<Item = Figure> {
    let force = task.peak_force_n.map(|force| Figure {
        name: format!("peak force{on}"),
        value: format!("{force:.0} N"),
        note: "between plug and socket, over the inserted trials".to_owned(),
    });
    let window = &task.measured.window;
    let range = Figure {
        name: format!("range{on}"),
        value: mm(window.range_mm()),
        note: format!("{} mm: {}", span(ends_mm(window)), ends(window)),
    };
    [range].into_iter().chain(force)
}

/// What springs computed from its ribs make of the finger, beside those of the paper.
fn with_ribs(found: &ByRibs, range_mm: Option<f64>) -> Figure {
    let note = match found {
        ByRibs::Refused(why) => why.clone(),
        ByRibs::Measured(tasks) => {
            let window = |Evaluation { window, taught: by, .. }: &Evaluation| {
                format!("{} mm{}: {}", span(ends_mm(window)), taught(*by, " mm"), ends(window))
            };
            let windows: Vec<String> = tasks.iter().map(window).collect();
            format!(
                "{}; the ranges beside it have the paper's one remote centre",
                windows.join("; ")
            )
        }
    };
    let value = range_mm.map_or("none".to_owned(), mm);
    Figure { name: "range with springs from its ribs".to_owned(), value, note }
}

/// How the bench orders fingers on a task.
fn order(known: &TaskOrder) -> String {
    let TaskOrder { task, order } = known;
    let advice = if known.beyond_chance() { "" } else { ", no more than chance gives" };
    format!(
        "On {task} {} ranked {} printed fingers with a correlation of {:+.2} to the bench{advice} (1: the same order).",
        order.source.words(),
        order.fingers,
        order.spearman,
    )
}

fn ends(window: &Window) -> String {
    format!("{} below, {} above", end(window.end_negative), end(window.end_positive))
}

/// How many designs are as good, and which of them to take for other reasons.
fn equivalent(as_good: &AsGood, of: usize) -> Vec<String> {
    let count = as_good.designs;
    if count < 2 {
        return vec![format!("No other of {of} designs is as good.")];
    }
    let line = |&Alternative { reason, design, value, unit }: &Alternative| {
        let (first, rest) = reason.split_at(1);
        let (first, label) = (first.to_uppercase(), design.design.labelled());
        format!("{first}{rest}: {label}, {value:.1} {unit} (evaluation {}).", design.index)
    };
    let mut lines = vec![format!("{count} of {of} designs are equivalent: choose by other needs.")];
    lines.extend(as_good.alternatives.iter().map(line));
    lines
}
