//! Designs that tie with the recommended one, and reasons to choose another.

use super::elements::stacked;
use crate::answer::words::{COMPLIANCE, design, mm, stiffness};
use crate::answer::{Answer, Ties, lines};
use insertion::Measure;
use maud::{Markup, html};
use study::Recorded;

/// Number of designs listed; the explorer has all.
const LISTED: usize = 8;

/// Returns the section; `None` if no finger is recommended, or for several objectives.
pub(super) fn section(answer: &Answer) -> Option<Markup> {
    answer.verdict.finger()?;
    let found = answer.recommended.as_ref()?.ties.as_ref()?;
    let named = answer.design_to_print()?.index;
    let mut designs = found.designs.clone();
    // Order: design to print, safe choice, all others by loss.
    let safe = found.safe.as_ref().map(|safe| safe.design.index);
    let order = |recorded: &Recorded| match recorded.index {
        index if index == named => 0,
        index if Some(index) == safe => 1,
        _ => 2,
    };
    designs.sort_by(|a, b| order(a.0).cmp(&order(b.0)).then(a.1.total_cmp(&b.1)));
    let millimetres = answer.record.config.objective.first().unit() == "mm";
    let on_robot = |recorded: &Recorded| answer.on_robot(&recorded.design);
    designs.truncate(LISTED);
    let any_measured = designs.iter().any(|(recorded, _)| on_robot(recorded).is_some());
    let row = |(recorded, loss): &(&Recorded, f64)| {
        let loss = if millimetres { mm(loss.max(0.0)) } else { String::new() };
        let force = answer.record.measure(recorded, Measure::PeakForce);
        let mut cells = vec![
            design(&recorded.design),
            reasons(answer, found, recorded, named),
            loss,
            force.map_or(String::new(), |force| format!("{force:.0} N")),
            stiffness(recorded.stiffness.compliance),
        ];
        cells.extend(any_measured.then(|| on_robot(recorded).map_or(String::new(), mm)));
        cells
    };
    let head = ["finger", "reason to choose it", "expected loss", "peak force", COMPLIANCE];
    let head: Vec<&str> = head.into_iter().chain(any_measured.then_some("measured")).collect();
    Some(html! {
        p { (lines::tied(answer, found).1) "." }
        @for (name, text) in lines::safe(found).into_iter().chain(lines::spread(answer)).chain(lines::edge(answer)) {
            p { b { (name) } " " (text) "." }
        }
        @if designs.len() > 1 { (stacked(&head, designs.iter().map(row))) }
        @if found.designs.len() > LISTED { p.muted { (found.designs.len() - LISTED) " more in the explorer." } }
    })
}

fn reasons(answer: &Answer, found: &Ties, recorded: &Recorded, named: u64) -> String {
    let is_recorded = |other: &&Recorded| other.index == recorded.index;
    // If there are measurements, the recommended finger may differ from the best one in simulation.
    let use_now = answer.use_now().is_none_or(|best| best.design == recorded.design);
    let recommended = answer.verdict.finger() == Some(&recorded.design) && use_now;
    let best = if recommended { "recommended" } else { "best in simulation" };
    let named = (recorded.index == named).then_some(best);
    let safe = found.safe.as_ref().filter(|safe| is_recorded(&safe.design)).map(|safe| safe.name());
    named.into_iter().chain(safe).collect::<Vec<_>>().join(", ")
}
