//! The best design in words.

use super::elements::definitions;
use super::text::{design, outcome, stiffness, values};
use super::{again, answer};
use crate::study::{Recorded, StudyRecord, nearest};
use insertion::evaluation::objective::Measure;
use insertion::evaluation::{Evaluation, RobustRange, SuccessRate, Window};
use insertion::outcome::{FailureClass, Outcome};
use maud::{Markup, html};

/// The section; says so if no design can be recommended.
pub(super) fn section(record: &StudyRecord) -> Markup {
    let Some(best) = record.recommended() else { return none(record) };
    let objectives = &record.config.objective;
    let found = best.feasible().unwrap_or_default();
    html! {
        p.big { (best.design.labelled()) }
        (answer::card(record, best))
        @if objectives.single().is_none() {
            p {
                "has the best " (objectives.first().name()) ": " (objectives.show(found))
                ". No one design is best in all objectives; see the front below."
            }
        }
        @for (task, evaluation) in record.config.tasks().zip(best.tasks()) {
            (unusable(record, task, &evaluation.window))
        }
        @if !best.stiffness.inside_hull() {
            p.warn {
                "Outside the hull of the measured designs, by "
                (format!("{:.2}", best.stiffness.hull_distance)) " of the measured span: the \
                stiffness is extrapolated. Print and measure this finger before you trust the \
                result."
            }
        }
        details { summary { "All its numbers" } (definitions(&facts(record, best, found))) }
        p {
            "The same study again, in its folder: "
            code { @for word in again::words(record) { span { (word) } " " } }
        }
    }
}

fn none(record: &StudyRecord) -> Markup {
    let count = record.evaluations.len();
    let Some(nearest) = nearest(&record.evaluations) else {
        return html! {
            p.warn {
                "No design has a value: of " (count) " evaluations none gave one (none were run, \
                or every simulation diverged at the nominal start, or none inserted there and so \
                had no force or slip)."
            }
        };
    };
    let tasks = nearest.tasks();
    let words: Vec<String> = record.config.constraints.iter().map(|c| c.words(&tasks)).collect();
    html! {
        p.warn {
            "No design keeps all constraints, so none is recommended. Of " (count) " evaluations, \
            evaluation " (nearest.index) " (" (design(&nearest.design)) ") violates them least: "
            (words.join("; ")) "."
        }
    }
}

/// That the best design is of no use on a task.
fn unusable(record: &StudyRecord, task: &str, window: &Window) -> Markup {
    let on = if record.config.several_tasks() { format!(" on {task}") } else { String::new() };
    html! {
        @if window.nominal != Outcome::Inserted {
            p.warn {
                "Even the best design fails at the nominal start" (on) ": "
                (outcome(window.nominal)) ", so its range is 0 mm. No design of this study is \
                usable as it is."
            }
        }
    }
}

type Facts = Vec<(String, String)>;

fn fact(name: &str, value: String) -> (String, String) {
    (name.to_owned(), value)
}

fn facts(record: &StudyRecord, best: &Recorded, found: &[f64]) -> Facts {
    let config = &record.config;
    let mut facts = Facts::new();
    let name = config.objective.single().map_or(String::new(), |measure| format!("{measure} = "));
    facts.push(fact("objective", name + &values(&config.objective, found)));
    facts.extend(walked(record, best));
    let tasks = best.tasks();
    facts.extend(config.constraints.iter().map(|c| fact("constraint", c.words(&tasks))));
    for (task, evaluation) in config.tasks().zip(&tasks) {
        if config.several_tasks() {
            facts.push(fact("on the task", task.to_owned()));
        }
        facts.extend(of_task(evaluation));
    }
    let of = format!("{} (the {} are counted from 0)", best.index, record.evaluations.len());
    facts.extend([
        fact("compliance stiffness (y), one finger", stiffness(best.stiffness.compliance)),
        fact("assembly stiffness (z), one finger", stiffness(best.stiffness.assembly)),
        fact("evaluation", of),
    ]);
    facts
}

/// That the best designs were walked, and what the search had found of this one.
fn walked(record: &StudyRecord, best: &Recorded) -> Option<(String, String)> {
    let count = record.walked.len();
    let searched = record.current().iter().find(|recorded| recorded.index == best.index)?;
    let before = values(&record.config.objective, searched.feasible().unwrap_or_default());
    let words = format!("step by step, as the best {count}; the search had found {before}");
    (count > 0).then(|| fact("walked", words))
}

/// What was measured on one task.
fn of_task(found: &Evaluation) -> Facts {
    let mut facts = window(&found.window);
    let most = |measure: Measure| {
        let value = measure.value(found)?;
        Some(format!("{} (over the inserted trials)", measure.show(value)))
    };
    let force = most(Measure::PeakForce);
    facts.extend(force.map(|force| fact("largest contact force plug to socket", force)));
    facts.extend(most(Measure::Slip).map(|slip| fact("largest slip in the grasp", slip)));
    facts.extend(found.success.iter().flat_map(success));
    facts.extend(found.robust.iter().map(robust));
    facts
}

fn window(window: &Window) -> Facts {
    if window.nominal != Outcome::Inserted {
        let ends = outcome(window.nominal);
        return vec![fact("window", format!("none: the nominal start ends with {ends}"))];
    }
    let end = |end: Option<Outcome>| {
        end.map_or("no failure up to the limit of the search".to_owned(), outcome)
    };
    let span = format!(
        "{:+.1} mm to {:+.1} mm: the last 0.1 mm step found to insert on each side",
        window.negative_mm(),
        window.positive_mm()
    );
    vec![
        fact("window", span),
        fact("beyond the negative end", end(window.end_negative)),
        fact("beyond the positive end", end(window.end_positive)),
    ]
}

fn success(success: &SuccessRate) -> Facts {
    let [low, high] = success.interval();
    let rate = success.rate().map_or("none".to_owned(), |rate| format!("{rate:.3}"));
    let rate = format!(
        "{rate} ({} of {} trials; {} % interval {low:.3} to {high:.3})",
        success.inserted,
        success.counted(),
        100.0 * success.confidence
    );
    let classes = FailureClass::ALL.into_iter().zip(success.failure_counts);
    let failed: Vec<String> = classes.map(|(class, n)| format!("{n} {}", class.label())).collect();
    let failed = format!("{}, {} diverged", failed.join(", "), success.diverged);
    vec![fact("success rate under drawn errors", rate), fact("failures under drawn errors", failed)]
}

fn robust(robust: &RobustRange) -> (String, String) {
    let value = robust.value_mm.map_or("none".to_owned(), |value| format!("{value:.2} mm"));
    let text = format!(
        "{value}; {} windows of mean {:.2} mm and standard deviation {:.2} mm, {} diverged",
        robust.ranges_mm.len(),
        robust.mean_mm(),
        robust.sd_mm(),
        robust.diverged
    );
    fact("robust range under drawn errors", text)
}
