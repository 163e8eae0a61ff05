//! The best design in words.

use super::elements::definitions;
use super::{again, answer};
use crate::answer::words::{design, outcome, robust, stiffness, success};
use crate::answer::{Answer, Nearest, OnTask, Recommended};
use insertion::evaluation::objective::Measure;
use insertion::outcome::Outcome;
use maud::{Markup, html};

/// The section; says so if no design can be recommended.
pub(super) fn section(answer: &Answer) -> Markup {
    let Some(found) = &answer.recommended else { return none(answer) };
    let (best, objectives) = (found.design, &answer.record.config.objective);
    html! {
        p.big { (best.design.labelled()) }
        (answer::card(answer, found))
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
        details { summary { "All its numbers" } (definitions(&facts(answer, found))) }
        p {
            "The same study again, in its folder: "
            code { @for word in again::words(answer.record) { span { (word) } " " } }
        }
    }
}

fn none(answer: &Answer) -> Markup {
    let count = answer.designs;
    let Some(Nearest { design: nearest, constraints }) = &answer.nearest else {
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

/// That the best design is of no use on a task.
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

type Facts = Vec<(String, String)>;

fn fact(name: &str, value: String) -> (String, String) {
    (name.to_owned(), value)
}

/// What the card does not say.
fn facts(answer: &Answer, found: &Recommended) -> Facts {
    let (best, several) = (found.design, found.tasks.len() > 1);
    let on_card = |measure| measure == Measure::Range && !several;
    let objective = found.objective.filter(|(measure, _)| !on_card(*measure));
    let show = |(measure, value): (Measure, f64)| format!("{measure} = {}", measure.show(value));
    let mut facts: Facts = objective.map(|one| fact("objective", show(one))).into_iter().collect();
    facts.extend(walked(answer, found));
    facts.extend(found.constraints.iter().map(|(_, words)| fact("constraint", words.clone())));
    for task in &found.tasks {
        facts.extend(several.then(|| fact("on the task", task.name.to_owned())));
        facts.extend(of_task(task));
    }
    let of = format!("{} (the {} are counted from 0)", best.index, answer.record.evaluations.len());
    facts.extend([
        fact("compliance stiffness (y), one finger", stiffness(best.stiffness.compliance)),
        fact("assembly stiffness (z), one finger", stiffness(best.stiffness.assembly)),
        fact("evaluation", of),
    ]);
    facts
}

/// That the best designs were walked, and what the search had found of this one, if that fell.
fn walked(answer: &Answer, found: &Recommended) -> Option<(String, String)> {
    let (measure, _) = found.objective.filter(|_| !answer.walked.is_empty())?;
    let before =
        found.searched.map(|value| format!("; the search had found {}", measure.show(value)));
    let count = answer.walked.len();
    Some(fact("walked", format!("step by step, as the best {count}{}", before.unwrap_or_default())))
}

/// What else was measured on one task.
fn of_task(task: &OnTask) -> Facts {
    let slip = Measure::Slip.value(task.measured);
    let slip = slip.map(|slip| format!("{} (over the inserted trials)", Measure::Slip.show(slip)));
    let mut facts: Facts =
        slip.map(|slip| fact("largest slip in the grasp", slip)).into_iter().collect();
    if let Some([rate, failures]) = task.measured.success.as_ref().map(success) {
        facts.push(fact("success rate under drawn errors", rate));
        facts.push(fact("failures under drawn errors", failures));
    }
    let range = task.measured.robust.as_ref().map(robust);
    facts.extend(range.map(|range| fact("robust range under drawn errors", range)));
    facts
}
