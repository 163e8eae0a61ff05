//! The evaluations to look into: a surface of the model, windows, course, force, all parameters
//! at once, linked by the evaluation that is chosen. The script is our own, 10 kB.

use super::drawn::drawn;
use super::surface;
use crate::answer::words::{end, ends_mm, success};
use crate::study::{Recorded, StudyRecord};
use insertion::evaluation::objective::Measure;
use insertion::outcome::Outcome;
use insertion::space::label;
use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};

pub(super) fn section(record: &StudyRecord) -> Option<Markup> {
    record.best()?;
    let view = |id: &str, label: &str, caption: &str| {
        html! { figure { svg id=(id) role="img" aria-label=(label) {} figcaption { (caption) } } }
    };
    let model = surface::Model::of(record);
    let importance = model.as_ref().map_or(Vec::new(), |model| surface::importance(record, model));
    Some(html! {
        p.muted {
            "Click a mark to choose an evaluation in all views; it turns red. The arrow keys go to the \
            next. The recommended one has a black ring in a white one."
        }
        div #explore tabindex="0" {
            p #selected aria-live="polite" {}
            div.views {
                figure {
                    svg #surface role="img" aria-label="mean of the model over two parameters" {}
                    svg #scale role="img" aria-label="colour scale" {}
                    figcaption {
                        "Mean of a Gaussian process through the evaluations, and the evaluations on it. \
                        Hover for its standard deviation. The scale begins at the lowest twentieth, so \
                        that failures do not flatten it; the other parameters are the recommended one's."
                    }
                }
                (view("bars", "windows as bars", "Windows of the 40 widest, the widest on top; the triangle points at the recommended one."))
                (view("course", "value against evaluation", "Value of each evaluation, and the best so far."))
                (view("force", "peak force against range", "Peak force against range."))
                (view("parallel", "all parameters", "All parameters and the value."))
            }
        }
        @if !importance.is_empty() {
            h3 { "What matters" }
            p {
                "Share of the model's variance over the space that a parameter makes by itself: "
                (importance.iter().map(|(name, share)| format!("{name} {:.0} %", 100.0 * share)).collect::<Vec<_>>().join(", "))
                ". What is missing to 100 % they make together."
            }
        }
        div #tip hidden role="status" {}
        script type="application/json" id="study" { (PreEscaped(embedded(&to_json(record, model.as_ref())))) }
        script { (PreEscaped(include_str!("explore.js"))) }
    })
}

/// JSON for a script element, which ends at the first `</`.
pub(super) fn embedded(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

fn to_json(record: &StudyRecord, model: Option<&surface::Model>) -> Value {
    let parameters = &record.config.space.parameters;
    let measure = record.config.objective.first();
    let named: Vec<Value> = parameters
        .iter()
        .map(|p| {
            let (name, unit) = label(&p.key);
            json!({"label": name, "unit": unit, "low": p.low, "high": p.high})
        })
        .collect();
    let evaluation = |recorded: &Recorded| {
        let x: Vec<f64> = parameters.iter().filter_map(|p| recorded.design.get(&p.key)).collect();
        let window = recorded.on(0).map(|found| &found.window);
        let inserts = window.filter(|window| window.nominal == Outcome::Inserted);
        json!({
            "index": recorded.index,
            "x": x,
            "value": recorded.known_value(),
            "raced": recorded.tasks.iter().filter(|_| recorded.raced()).filter_map(|task| task.success.as_ref())
                .map(|rate| success(rate)[0].clone()).reduce(|all, one| format!("{all}; {one}")),
            "feasible": recorded.feasible().is_some(),
            "window": inserts.map(ends_mm),
            "ends": window.map(|w| [end(w.end_negative), end(w.end_positive)]),
            "force": recorded.on(0).and_then(|found| Measure::PeakForce.value(found)),
        })
    };
    json!({
        "parameters": named,
        "measure": {"label": measure.label(), "name": measure.name(), "unit": measure.unit(), "sense": measure.sense()},
        "evaluations": drawn(record, record.current()).into_iter().map(evaluation).collect::<Vec<_>>(),
        "best": record.recommended().map(|best| best.index),
        "model": model.and_then(|model| surface::to_json(record, model)),
    })
}
