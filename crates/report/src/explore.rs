//! Explorer of all designs: the model as a surface over two parameters, a table, and details of one or two selected
//! designs. A script draws it; without scripts there is a table of the best designs.

use super::elements::table;
use super::selection::{LISTED, selected};
use super::surface;
use crate::answer::words::{self, end, ends_mm, mm, rounded, span, success};
use crate::answer::{Answer, command};
use input::units::N_PER_MM;
use insertion::{DENSITY_KEY, DIRECTION_KEY, Measure, Outcome, Variable, Window};
use maud::{Markup, PreEscaped, html};
use parameters::label;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use study::{Recorded, StudyRecord};

/// Number of designs in the table without the script.
const SHOWN: usize = 10;

pub(super) fn section(answer: &Answer, dir: &Path) -> Option<Markup> {
    let record = answer.record;
    record.best()?;
    let model = surface::model(record);
    let data = data(answer, model.as_ref(), dir);
    Some(html! {
        p.muted {
            "Values of the search"
            @if !answer.walked.is_empty() { ", before the best were confirmed" }
            ". Click a mark or a row to see a design; the arrow keys select the next. A mark with bars fails \
            at the nominal start; the recommended one has a ring, and stays at the top of the table."
        }
        div #explore tabindex="0" {
            figure #map {
                p #shown hidden {
                    label { input type="radio" name="shown" value="mean" checked; " model's mean" }
                    label { input type="radio" name="shown" value="sd"; " its standard deviation" }
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

/// Returns the best feasible designs, the recommended one first; for several objectives the front.
fn best(answer: &Answer) -> Markup {
    let record = answer.record;
    let goals = record.config.goals();
    let all: Vec<&Recorded> = match goals.objectives.single() {
        Some(_) => record.current().iter().collect(),
        None => record.front(),
    };
    let mut best: Vec<(&Recorded, &[f64])> =
        all.into_iter().filter_map(|found| Some((found, found.feasible()?))).collect();
    // The sorts are stable: designs of equal value stay in their order.
    best.sort_by(|a, b| goals.order(b.1, a.1));
    let named = answer.design_to_print().map(|named| named.index);
    best.sort_by_key(|(found, _)| Some(found.index) != named);
    best.truncate(SHOWN);
    let on_robot = |found: &Recorded| answer.on_robot(&found.design);
    let any_measured = best.iter().any(|(found, _)| on_robot(found).is_some());
    let row = |(found, values): &(&Recorded, &[f64])| {
        let window = &found.on(0)?.window;
        let mut cells = vec![
            found.index.to_string(),
            words::design(&found.design),
            words::values(&record.config.objective, values),
            format!("{} mm", span(ends_mm(window))),
            ends(window).join(" | "),
        ];
        cells.extend(any_measured.then(|| on_robot(found).map_or(String::new(), mm)));
        Some(cells)
    };
    let mut head = vec!["evaluation", "design", "value in the search", "window", "ends"];
    head.extend(any_measured.then_some("measured"));
    table(&head, best.iter().filter_map(row))
}

fn ends(window: &Window) -> [String; 2] {
    [window.end_negative, window.end_positive].map(end)
}

/// Returns JSON for a script element, with `<` escaped, because `</script` would end the element.
pub(super) fn embedded(data: &Value) -> String {
    data.to_string().replace('<', "\\u003c")
}

/// Returns the data of the explorer as JSON: parameters, measure, evaluations as by [`row`], and, by evaluation, ranges
/// measured on a robot (mm), bounds of designs whose race was lost, and firm ranges (mm).
fn data(answer: &Answer, model: Option<&impl Fn(&[f64]) -> (f64, f64)>, dir: &Path) -> Value {
    let (record, config) = (answer.record, &answer.record.config);
    let measure = config.objective.first();
    let parameter = |p: &Variable| {
        let (label, unit) = label(&p.key);
        let option = match &*p.key {
            DENSITY_KEY => "--density ".to_owned(),
            DIRECTION_KEY => "--direction ".to_owned(),
            key => format!("--set {key}="),
        };
        json!({"label": label, "unit": unit, "low": p.low, "high": p.high, "option": option})
    };
    let shown = selected(record, record.current(), LISTED);
    let robot = |found: &&Recorded| Some((found.index, answer.on_robot(&found.design)?));
    let confirmed = answer.walked.iter().map(|(found, mm)| (found.index, *mm));
    let finger = answer.verdict.finger();
    let best = record.current().iter().find(|found| Some(&found.design) == finger);
    let raced = |found: &&Recorded| Some((found.index, bound(found)?));
    let mut outcomes = Vec::new();
    let row = |found: &&Recorded| row(record, found, &mut outcomes);
    let evaluations: Value = shown.iter().map(row).collect();
    json!({
        "parameters": config.space.parameters.iter().map(parameter).collect::<Value>(),
        "measure": {
            "label": measure.label(),
            "name": measure.name(),
            "unit": measure.unit(),
            "sense": measure.sense(),
        },
        "robot": shown.iter().filter_map(robot).collect::<BTreeMap<_, _>>(),
        "raced": shown.iter().filter_map(raced).collect::<BTreeMap<_, _>>(),
        "confirmed": confirmed.collect::<BTreeMap<_, _>>(),
        "evaluations": evaluations,
        "outcomes": outcomes,
        "on": words::on(config, config.tasks().next().unwrap_or_default()),
        "best": best.map(|best| best.index),
        "command": command::trial(record, dir),
        "model": model.and_then(|model| surface::of(answer, model)),
    })
}

/// Returns the upper bound of the success rate in words; `None` unless the evaluation was stopped early, because the
/// design could no longer be the best (raced).
fn bound(found: &Recorded) -> Option<String> {
    let tasks = found.tasks.iter().filter(|_| found.raced());
    let rates = tasks.filter_map(|task| task.success.as_ref()).map(|rate| success(rate)[0].clone());
    rates.reduce(|all, one| format!("{all}; {one}"))
}

/// Returns an evaluation as a list, which is shorter than an object: index, parameters, value, whether it is feasible
/// (1 or 0), both ends (mm), the outcomes there (as indices of `outcomes`), peak force (N) and stiffness along y
/// (N/mm).
fn row(record: &StudyRecord, found: &Recorded, outcomes: &mut Vec<String>) -> Value {
    let parameters = record.config.space.parameters.iter();
    let window = found.on(0).map(|found| &found.window);
    let inserts = window.filter(|window| window.nominal == Outcome::Inserted);
    let mut index = |word: String| {
        outcomes.iter().position(|other| *other == word).unwrap_or_else(|| {
            outcomes.push(word);
            outcomes.len() - 1
        })
    };
    let tenth = |value: f64| rounded(value, 1);
    json!([
        found.index,
        parameters.filter_map(|p| found.design.get(&p.key)).collect::<Vec<_>>(),
        found.known_value().map(|value| (1e3 * value).round() / 1e3),
        u8::from(found.feasible().is_some()),
        inserts.map(|window| ends_mm(window).map(tenth)),
        window.map(|window| match inserts {
            Some(_) => ends(window).map(&mut index).to_vec(),
            None => vec![index(words::outcome(window.nominal))],
        }),
        found.on(0).and_then(|found| Measure::PeakForce.value(found)).map(tenth),
        (100.0 * found.stiffness.compliance.mean / N_PER_MM).round() / 100.0,
    ])
}
