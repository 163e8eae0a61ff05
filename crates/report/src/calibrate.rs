//! Text output of `optimize calibrate`: predicted ranges on the user's robot (bench) and posteriors of the parameters.

use super::text_table;
use crate::answer::words::{design, others};
use calibration::calibrate::{Calibration, Coordinate, TaskResult};
use calibration::predict::INTERVAL;
use calibration::subject::Subject;
use calibration::table::{ParameterUpdate, best_fingers, confounded, updates, warning};

/// Returns the result for a task as text within 80 columns.
pub fn text(subject: &Subject, result: &TaskResult) -> String {
    let accuracy = result.accuracy(subject.emulator.error_mm);
    let Subject { emulator, task, .. } = subject;
    let (verdict, measured) = (result.verdict().text, subject.measured().len());
    let mut text = format!(
        "{task}: {verdict}\n{task}: {measured} measured fingers; {} simulations, emulated within {:.2} mm ({} held out)\n",
        emulator.simulations, emulator.error_mm, emulator.held_out
    );
    if let Some(deviation) = accuracy.mean_deviation_percent {
        let rank = accuracy.spearman.map_or("-".to_owned(), |rank| format!("{rank:+.2}"));
        text += &format!(
            "leave-one-out  {deviation:.1} % off, Spearman {rank}, {} of {} in the {:.0} % interval\n",
            accuracy.inside,
            accuracy.fingers,
            100.0 * INTERVAL
        );
    }
    let best = || best_fingers(subject, result).into_iter();
    let rows = best().map(|one| {
        [
            design(&one.design),
            format!("{:.1}", one.range_mm),
            format!("{:.1} to {:.1}", one.low_mm, one.high_mm),
            format!("{:.1} %", 100.0 * one.probability_best),
            format!("{:.1}", one.simulated_mm),
        ]
    });
    let head = ["best on the bench", "range mm", "80 % interval", "is the best", "uncorrected"];
    text += &text_table(1, head, rows);
    let others = others(best().map(|one| one.probability_best), result.predictions.len());
    text.extend(others.map(|words| format!("is the best: {words}\n")));
    text.extend(warning(subject).iter().map(|words| format!("warning: {words}\n")));
    text
}

/// Returns prior and posterior 10 % to 90 % intervals of the parameters as a table within 80 columns.
pub fn parameters_text(calibration: &Calibration) -> String {
    let row = |(one, Coordinate { parameter, .. }): (ParameterUpdate, &Coordinate)| {
        let span = |low: f64, high: f64| parameter.with_unit(&format!("{low:.2} to {high:.2}"));
        let task = one.task.map_or(String::new(), |task| format!(" ({task})"));
        let moved = if one.moved { "yes" } else { "no" }.to_owned();
        let after = span(one.posterior_low, one.posterior_high);
        [one.name + &task, span(one.prior_low, one.prior_high), after, moved]
    };
    let head = ["parameter (×: of its file)", "before, 10 to 90 %", "after", "moved"];
    let alike = confounded(calibration).into_iter().map(|pair| {
        let ([a, b], correlation) = (pair.parameters, pair.correlation);
        format!("not distinguished: {a} and {b} (correlation {correlation:+.2})\n")
    });
    let rows = updates(calibration).into_iter().zip(&calibration.layout.coordinates).map(row);
    text_table(1, head, rows) + &alike.collect::<String>()
}
