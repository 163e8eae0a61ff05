//! Predicted ranges of the fingers on the bench, the user's robot.

use super::elements::table;
use crate::answer::words::{design, interval, mm, others};
use insertion::FailureClass;
use maud::{Markup, html};
use study::{BenchFinger, StudyRecord};

/// File with the predictions for every finger of the space, next to the page.
const TABLE: &str = "bench_predictions.csv";

/// Returns the section; `None` without measurements.
pub(super) fn section(record: &StudyRecord) -> Option<Markup> {
    let found = record.on_bench.as_ref()?;
    let others = others(found.best.iter().map(|one| one.probability_best), found.fingers);
    Some(html! {
        (table(
            &["finger", "range on the bench", "80 % interval", "probability of the best", "fails below | above"],
            found.best.iter().map(row),
        ))
        @if let Some(words) = others { p { "Probability of the best: " (words) "." } }
        p {
            "From " (found.effort.simulations) " simulations with drawn friction, preload, robot and print, and the \
            measurements; the error of the emulator (a Gaussian process) on further simulations is "
            (format!("{:.2}", found.trust.emulator_error_mm)) " mm. The search did not use the measurements: it \
            maximized the simulated window. " a href=(TABLE) { "All predicted fingers" } "."
        }
    })
}

fn row(finger: &BenchFinger) -> Vec<String> {
    let class = |class: Option<FailureClass>| class.map_or("–", FailureClass::label);
    let [below, above] = finger.failures.map(class);
    vec![
        design(&finger.design),
        mm(finger.range_mm),
        interval([finger.low_mm, finger.high_mm]),
        format!("{:.1} %", 100.0 * finger.probability_best),
        format!("{below} | {above}"),
    ]
}
