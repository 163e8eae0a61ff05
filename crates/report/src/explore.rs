//! The explorer of all designs: a surface of the model, a table, and what is known of the one or two
//! that are chosen. Our own script draws it; without it the table has the best designs.

use super::drawn::{LISTED, drawn};
use super::elements::table;
use super::surface;
use crate::answer::words::{self, end, ends_mm, mm, span, success};
use crate::answer::{Answer, command};
use input::units::N_PER_MM;
use insertion::evaluation::Window;
use insertion::evaluation::objective::Measure;
use insertion::outcome::Outcome;
use insertion::space::{DENSITY_KEY, DIRECTION_KEY, label};
use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use study::{Recorded, StudyRecord};

/// Designs in the table without the script.
const SHOWN: usize = 10;

pub(super) fn section(answer: &Answer, dir: &Path) -> Option<Markup> {
    let record = answer.record;
    record.best()?;
    let model = surface::Model::of(record);
    let data = to_json(answer, model.as_ref(), dir);
    Some(html! {
        p.muted {
            "Values as the search found them"
            @if !answer.walked.is_empty() { ", before the best were repeated: the widest here need not stay so" }
            ". Click a mark or a line to see a design; the arrow keys go to the next. A mark with bars fails \
            at the nominal start; the one in a ring is recommended."
        }
        div #explore tabindex="0" {
            figure #map {
                p #shown hidden {
                    label { input type="radio" name="shown" value="mean" checked; " model's mean" }
                    label { input type="radio" name="shown" value="sd"; " its deviation" }
                }
                svg #surface role="img" aria-label="the model over two parameters, and the designs" {}
                svg #scale role="img" aria-label="colour scale" {}
                @if model.is_some() { figcaption {
                    "A Gaussian process through the designs"
                    @if record.config.space.parameters.len() > 2 { ", the other parameters as recommended" }
                    "."
                } }
            }
            div #designs { (best(answer)) }
            div #selected aria-live="polite" {}
        }
        div #tip hidden role="status" {}
        script type="application/json" id="study" { (PreEscaped(embedded(&data))) }
        script { (PreEscaped(include_str!("explore.js"))) }
    })
}

/// The best designs that keep all constraints, the named one first; of several objectives the front.
fn best(answer: &Answer) -> Markup {
    let record = answer.record;
    let goals = record.config.goals();
    let all: Vec<&Recorded> = match goals.objectives.single() {
        Some(_) => record.current().iter().collect(),
        None => record.front(),
    };
    let mut best: Vec<(&Recorded, &[f64])> =
        all.into_iter().filter_map(|found| Some((found, found.feasible()?))).collect();
    // Stable, so that equals stay in their order.
    best.sort_by(|a, b| goals.order(b.1, a.1));
    let named = answer.named().map(|named| named.index);
    best.sort_by_key(|(found, _)| Some(found.index) != named);
    let row = |(found, values): &(&Recorded, &[f64])| {
        let window = &found.on(0)?.window;
        let robot = answer.measured.iter().find(|measured| measured.design == found.design);
        Some(vec![
            found.index.to_string(),
            words::design(&found.design),
            words::values(&record.config.objective, values),
            format!("{} mm", span(ends_mm(window))),
            ends(window).join(" | "),
            robot.map_or(String::new(), |measured| mm(measured.range_mm)),
        ])
    };
    let head = ["evaluation", "design", "searched value", "window", "ends", "on a robot"];
    table(&head, &best.iter().take(SHOWN).filter_map(row).collect::<Vec<_>>())
}

fn ends(window: &Window) -> [String; 2] {
    [window.end_negative, window.end_positive].map(end)
}

/// JSON for a script element, which ends at the first `</`.
pub(super) fn embedded(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

fn to_json(answer: &Answer, model: Option<&surface::Model>, dir: &Path) -> Value {
    let record = answer.record;
    let (parameters, measure) = (&record.config.space.parameters, record.config.objective.first());
    let parameter = |p: &insertion::space::Variable| {
        let (name, unit) = label(&p.key);
        let option = match p.key.as_str() {
            DENSITY_KEY => "--density ".to_owned(),
            DIRECTION_KEY => "--direction ".to_owned(),
            key => format!("--set {key}="),
        };
        json!({"label": name, "unit": unit, "low": p.low, "high": p.high, "option": option})
    };
    let shown = drawn(record, record.current(), LISTED);
    let robot = |found: &&Recorded| {
        let measured = answer.measured.iter().find(|measured| measured.design == found.design)?;
        Some((found.index, measured.range_mm))
    };
    let finger = answer.verdict.finger();
    let best = record.current().iter().find(|found| Some(&found.design) == finger);
    let raced = |found: &&Recorded| Some((found.index, bound(found)?));
    let mut outcomes = Vec::new();
    let evaluations: Vec<Value> =
        shown.iter().map(|found| evaluation(record, found, &mut outcomes)).collect();
    json!({
        "parameters": parameters.iter().map(parameter).collect::<Vec<_>>(),
        "measure": {"label": measure.label(), "name": measure.name(), "unit": measure.unit(), "sense": measure.sense()},
        "robot": shown.iter().filter_map(robot).collect::<BTreeMap<_, _>>(),
        "raced": shown.iter().filter_map(raced).collect::<BTreeMap<_, _>>(),
        "confirmed": answer.walked.iter().map(|(found, firm_mm)| (found.index, firm_mm)).collect::<BTreeMap<_, _>>(),
        "evaluations": evaluations,
        "outcomes": outcomes,
        "on": if record.config.several_tasks() { format!(" on {}", record.config.tasks().next().unwrap_or_default()) } else { String::new() },
        "best": best.map(|best| best.index),
        "command": command::trial(record, dir),
        "model": model.and_then(|model| surface::to_json(record, model)),
    })
}

/// At most so many of the draws insert; `None` of a design that was not raced.
fn bound(found: &Recorded) -> Option<String> {
    let tasks = found.tasks.iter().filter(|_| found.raced());
    let rates = tasks.filter_map(|task| task.success.as_ref()).map(|rate| success(rate)[0].clone());
    rates.reduce(|all, one| format!("{all}; {one}"))
}

/// Number, parameters, value, whether it keeps all constraints, both ends, mm, what ends it there (by
/// place among the `outcomes`), largest force, N, and stiffness across, N/mm; short, for there may be
/// thousands.
fn evaluation(record: &StudyRecord, found: &Recorded, outcomes: &mut Vec<String>) -> Value {
    let parameters = record.config.space.parameters.iter();
    let x: Vec<f64> = parameters.filter_map(|p| found.design.get(&p.key)).collect();
    let window = found.on(0).map(|found| &found.window);
    let inserts = window.filter(|window| window.nominal == Outcome::Inserted);
    let mut place = |word: String| match outcomes.iter().position(|other| *other == word) {
        Some(place) => place,
        None => {
            outcomes.push(word);
            outcomes.len() - 1
        }
    };
    let tenth = |value: f64| (10.0 * value).round() / 10.0;
    json!([
        found.index,
        x,
        found.known_value().map(|value| (1e3 * value).round() / 1e3),
        u8::from(found.feasible().is_some()),
        inserts.map(|window| ends_mm(window).map(tenth)),
        window.map(|window| match inserts {
            Some(_) => ends(window).map(&mut place).to_vec(),
            None => vec![place(words::outcome(window.nominal))],
        }),
        found.on(0).and_then(|found| Measure::PeakForce.value(found)).map(tenth),
        (100.0 * found.stiffness.compliance.mean / N_PER_MM).round() / 100.0,
    ])
}
