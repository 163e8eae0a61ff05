//! Gain from the parameters of the finger's shape, in addition to the infill.

use super::printer::finger_file;
use crate::answer::Answer;
use crate::answer::words::evaluated;
use insertion::finger::file::is_shape;
use insertion::{Evaluation, Measure, Variable};
use maud::{Markup, html};
use parameters::label;
use study::Recorded;

/// Returns the section; `None` if the space has no parameter of the finger's shape.
pub(super) fn section(answer: &Answer) -> Option<Markup> {
    let record = answer.record;
    let parameters = &record.config.space.parameters;
    let shape: Vec<&Variable> = parameters.iter().filter(|p| is_shape(&p.key)).collect();
    let index = answer.recommended.as_ref().filter(|_| !shape.is_empty())?.design.index;
    // The evaluation of the search, because the designs in the comparison were not confirmed.
    let best = record.current().iter().find(|recorded| recorded.index == index)?;
    let file = finger_file(record)?;
    let of_file: Vec<(&str, f64)> = shape
        .iter()
        .filter_map(|p| Some((&*p.key, p.value(p.nearest(file.numbers.number(&p.key)?)))))
        .collect();
    let has_finger_of_file = |recorded: &&Recorded| {
        of_file.iter().all(|(key, value)| recorded.design.get(key) == Some(*value))
    };
    let infill_only =
        study::best(&record.config.goals(), record.current().iter().filter(has_finger_of_file));
    let change = |&(key, from): &(&str, f64)| {
        let (to, (name, unit)) = (best.design.get(key)?, label(key));
        (from != to).then(|| format!("{name} {to}{unit} instead of {from}{unit}"))
    };
    let changed: Vec<String> = of_file.iter().filter_map(change).collect();
    Some(html! {
        @match infill_only {
            Some(infill_only) => p { "Compared with the best design that changes only the infill, " (evaluated(infill_only)) ": " (gain(infill_only, best)) }
            None => p { "No evaluation of this study has the finger of the finger file." }
        }
        @if changed.is_empty() {
            p { "The best design has the finger of the finger file." }
        } @else {
            p.warn {
                "It differs from the measured fingers: " (changed.join(", ")) ". Its stiffness was \
                computed from its ribs and scaled by the ratio of measured to computed stiffness at its infill; the \
                standard deviation includes the scatter of that ratio. Print \
                and measure this finger before you rely on the result."
            }
        }
    })
}

/// Returns a clause on the change of range and force from one design to another, task by task.
fn gain(infill_only: &Recorded, best: &Recorded) -> String {
    let of = |(before, now): (&Evaluation, &Evaluation)| {
        let [force, other] = [now, before].map(|task| Measure::PeakForce.show(task.peak_force_n));
        let change = now.window.range_mm() - before.window.range_mm();
        format!("{change:+.1} mm of range, with {force} instead of {other}")
    };
    let gains = infill_only.tasks.iter().zip(&best.tasks).map(of);
    format!("the finger's parameters give {}.", gains.collect::<Vec<_>>().join("; "))
}
