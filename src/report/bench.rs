//! What measurements say of the fingers on the bench: what a study with measurements leads with.

use super::elements::table;
use crate::answer::words::{infill, interval, mm};
use crate::study::{BenchFinger, OnBench, StudyRecord, Trust};
use insertion::evaluation::objective::Measure;
use insertion::outcome::FailureClass;
use maud::{Markup, html};

/// Every finger of the space as predicted, beside the page.
const TABLE: &str = "bench_predictions.csv";

/// The section; `None` without measurements.
pub(super) fn section(record: &StudyRecord) -> Option<Markup> {
    let found = record.on_bench.as_ref()?;
    let best = found.best.first()?;
    let simulated = Measure::Range.value(&found.simulated);
    Some(html! {
        p.big { (infill(&best.design)) }
        p {
            "is predicted to tolerate a start shifted by " b { (mm(best.range_mm)) }
            " in all on the bench (80 % interval " (interval([best.low_mm, best.high_mm])) "). "
            "It is the best of all " (found.fingers) " fingers with a probability of "
            (format!("{:.1} %", 100.0 * best.probability_best))
            ": neighbours share that. The simulation alone gives it "
            (simulated.map_or("no window".to_owned(), mm)) "."
        }
        div.card {
            p { (trust(found.measured, &found.trust)) }
            @for warning in &found.warnings { p.warn { (warning) } }
            p { a href=(TABLE) { "table of all predicted fingers" } }
        }
        (table(
            &["finger", "range on the bench", "80 % interval", "is the best", "fails below | above"],
            &found.best.iter().map(row).collect::<Vec<_>>(),
        ))
        p { (how(found)) }
    })
}

/// How far the prediction is to be trusted.
fn trust(measured: usize, trust: &Trust) -> String {
    let fingers = match measured {
        1 => "1 finger was measured".to_owned(),
        count => format!("{count} fingers were measured"),
    };
    let Some(deviation) = trust.mean_deviation_percent else { return format!("{fingers}.") };
    let rank = trust.spearman.map_or("no order".to_owned(), |rank| format!("Spearman {rank:+.2}"));
    format!(
        "{fingers}. Each predicted without it: {deviation:.1} % off on average, {rank}, {} of {} \
         inside their 80 % intervals.",
        trust.inside, trust.fingers
    )
}

fn row(finger: &BenchFinger) -> Vec<String> {
    let class = |class: Option<FailureClass>| class.map_or("–", FailureClass::label);
    let [below, above] = finger.failures.map(class);
    vec![
        infill(&finger.design),
        mm(finger.range_mm),
        interval([finger.low_mm, finger.high_mm]),
        format!("{:.1} %", 100.0 * finger.probability_best),
        format!("{below} | {above}"),
    ]
}

fn how(found: &OnBench) -> String {
    let simulations = found.effort.simulations;
    format!(
        "From {simulations} simulations under drawn friction, preload, robot and print, and the \
         measurements; the Gaussian process that stands in for the simulator misses fresh ones by \
         {:.2} mm. The search below did not know the measurements: it looked for the widest simulated \
         window.",
        found.trust.emulator_error_mm
    )
}
