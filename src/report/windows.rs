//! Tolerance windows of the best designs.

use super::elements::table;
use crate::answer::words::{self, ends_mm, span};
use crate::study::{Recorded, StudyRecord};
use maud::{Markup, html};

const SHOWN: usize = 10;

/// The best evaluations that keep all constraints, best first; equals in the order they were
/// measured. Of several objectives those on the front.
fn best(record: &StudyRecord) -> Vec<(&Recorded, &[f64])> {
    let goals = record.config.goals();
    let mut best: Vec<(&Recorded, &[f64])> = match goals.objectives.single() {
        Some(_) => record.evaluations.iter().filter_map(|r| Some((r, r.feasible()?))).collect(),
        None => record.front().into_iter().filter_map(|r| Some((r, r.feasible()?))).collect(),
    };
    // Stable, so that equals stay in their order.
    best.sort_by(|a, b| goals.order(b.1, a.1));
    best.truncate(SHOWN);
    best
}

/// The windows on one task, by its place among the tasks, as a table; `explore.js` draws them.
pub(super) fn section(record: &StudyRecord, task: usize) -> Markup {
    let best = best(record);
    if best.is_empty() {
        return html! { p { "No evaluation has a value and keeps all constraints." } };
    }
    let row = |(r, found): &(&Recorded, &[f64])| {
        let window = &r.on(task)?.window;
        Some(vec![
            r.index.to_string(),
            words::design(&r.design),
            words::values(&record.config.objective, found),
            format!("{} mm", span(ends_mm(window))),
            format!("{} / {}", words::end(window.end_negative), words::end(window.end_positive)),
            words::stiffness(r.stiffness.compliance),
            if r.stiffness.inside_hull() { "inside" } else { "outside" }.to_owned(),
        ])
    };
    let head = [
        "evaluation",
        "design",
        "objective",
        "window",
        "ends",
        "compliance stiffness",
        "measured hull",
    ];
    table(&head, &best.iter().filter_map(row).collect::<Vec<_>>())
}
