//! The best design in words: what it tolerates at a glance, and all lines of the terminal.

use super::elements::definitions;
use crate::answer::command;
use crate::answer::lines::{self, Line};
use crate::answer::words::{design, end, ends_mm, mm, outcome, span};
use crate::answer::{Answer, OnTask, Recommended};
use input::units::N_PER_MM;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::robustness::firm::REPEATS;
use insertion::outcome::Outcome;
use maud::{Markup, html};

/// The section; says so if no design can be recommended.
pub(super) fn section(answer: &Answer) -> Markup {
    let Some(found) = &answer.recommended else { return none(answer) };
    let (best, objectives) = (found.design, &answer.record.config.objective);
    // What the figures above do not say, and everything.
    let facts = facts(answer, found);
    let seen = |(name, _): &&Line| ["from its ribs", "as good", "robot"].contains(&name.as_str());
    let beside: Vec<Line> = facts.iter().filter(seen).cloned().collect();
    html! {
        p.big { (best.design.labelled()) }
        div.card {
            dl.figures {
                @for [name, value, note] in figures(found) {
                    div { dt { (name) } dd { b { (value) } } dd.muted { (note) } }
                }
            }
            p {
                a href="evaluations.csv" { "table of all evaluations" } ", "
                a href="journal.jsonl" { "journal" } ", "
                a href="convergence.svg" { "convergence" }
            }
        }
        @if answer.front.is_some() {
            p {
                "has the best " (objectives.first().name()) ": "
                (objectives.show(best.feasible().unwrap_or_default()))
                ". No one design is best in all objectives; see the front below."
            }
        }
        @for task in &found.tasks { (unusable(task, &found.on(task))) }
        @if !best.stiffness.inside_hull() {
            p.warn {
                "Outside the hull of the measured designs, by "
                (format!("{:.2}", best.stiffness.hull_distance)) " of the measured span: the \
                stiffness is extrapolated. Print and measure this finger before you trust the \
                result."
            }
        }
        (definitions(&beside))
        details {
            summary { "All its numbers" }
            (definitions(&facts))
        }
        p { "Print and measure more than one: " code { "optimize next" } " says which." }
        p {
            "The same study again, in its folder: "
            code { @for word in command::again(answer.record) { span { (word) } " " } }
        }
    }
}

fn none(answer: &Answer) -> Markup {
    let count = answer.designs;
    let Some((nearest, constraints)) = &answer.nearest else {
        return html! {
            p.warn {
                "No design has a value: of " (count) " evaluations none gave one (none were run, \
                or every simulation diverged at the nominal start, or none inserted there and so \
                had no force or slip)."
            }
        };
    };
    html! {
        p.warn {
            "No design keeps all constraints, so none is recommended. Of " (count) " evaluations, \
            evaluation " (nearest.index) " (" (design(&nearest.design)) ") violates them least: "
            (constraints.join("; ")) "."
        }
    }
}

fn unusable(task: &OnTask, on: &str) -> Markup {
    let nominal = task.measured.window.nominal;
    html! {
        @if nominal != Outcome::Inserted {
            p.warn {
                "Even the best design fails at the nominal start" (on) ": " (outcome(nominal)) ", \
                so its range is 0 mm. No design of this study is usable as it is."
            }
        }
    }
}

/// Numbers to be seen at a glance: name, value, and what is to be known of it.
fn figures(found: &Recommended) -> Vec<[String; 3]> {
    let mut figures = Vec::new();
    if let Some(range) = found.firm_range_mm {
        let window = found.firm_window_mm.filter(|_| found.tasks.len() == 1);
        let window = window.map_or(String::new(), |window| format!("{} mm: ", span(window)));
        let repeats =
            format!("{REPEATS} of {REPEATS} repeats with friction, start and step varied");
        figures.push(["firm range".to_owned(), mm(range), format!("{window}inserts in {repeats}")]);
    }
    for task in &found.tasks {
        let (on, window) = (found.on(task), &task.measured.window);
        let [below, above] = [window.end_negative, window.end_positive].map(end);
        let note = format!("{} mm: {below} below, {above} above", span(ends_mm(window)));
        figures.push([format!("range{on}"), mm(window.range_mm()), note]);
        figures.extend(Measure::PeakForce.value(task.measured).map(|force| {
            let note = "between plug and socket, over the inserted trials".to_owned();
            [format!("peak force{on}"), format!("{force:.0} N"), note]
        }));
    }
    let stiffness = &found.design.stiffness;
    let source = if stiffness.inside_hull() { "interpolated between" } else { "extrapolated from" };
    let along = stiffness.assembly.mean / N_PER_MM;
    figures.push([
        "stiffness of one finger".to_owned(),
        format!("{:.1} N/mm", stiffness.compliance.mean / N_PER_MM),
        format!("across the insertion, {along:.0} N/mm along it; {source} the measured designs"),
    ]);
    figures
}

/// The lines of the terminal, and what they do not say.
fn facts(answer: &Answer, found: &Recommended) -> Vec<Line> {
    let mut facts = lines::recommended(answer, found);
    let mut add = |name: &str, value: String| facts.push((name.to_owned(), value));
    for task in &found.tasks {
        if let Some(slip) = Measure::Slip.value(task.measured) {
            add(&format!("largest slip in the grasp{}", found.on(task)), Measure::Slip.show(slip));
        }
    }
    facts
}
