//! Text output of `optimize calibrate`: bench predictions and posteriors of the parameters.

use super::text_table;
use calibration::calibrate::{Calibration, TaskResult};
use calibration::predict::INTERVAL;
use calibration::subject::Subject;
use calibration::table::{Moved, by_range, moved, together, warnings};
use insertion::space::{DENSITY_KEY, DIRECTION_KEY};

/// Number of fingers in the table.
const LISTED: usize = 5;

/// Returns the result for a task, within 80 columns.
pub fn text(subject: &Subject, result: &TaskResult) -> String {
    let accuracy = result.trust(subject.emulator.error_mm);
    let emulator = &subject.emulator;
    let mut text = format!(
        "{}: {} measured fingers; {} simulations, emulated within {:.2} mm ({} fresh ones)\n",
        subject.task,
        subject.measured().len(),
        emulator.simulations,
        emulator.error_mm,
        emulator.fresh
    );
    if let Some(deviation) = accuracy.mean_deviation_percent {
        let rank = accuracy.spearman.map_or("-".to_owned(), |rank| format!("{rank:+.2}"));
        text += &format!(
            "leave-one-out  {deviation:.1} % off on average, Spearman {rank}, {} of {} in the {:.0} % interval\n",
            accuracy.inside,
            accuracy.fingers,
            100.0 * INTERVAL
        );
    }
    let best = by_range(result).into_iter().take(LISTED).map(|prediction| {
        let value = |key: &str| subject.designs[prediction.finger].get(key).unwrap_or(f64::NAN);
        let range = &prediction.range;
        [
            format!("density {} %, direction {}°", value(DENSITY_KEY), value(DIRECTION_KEY)),
            format!("{:.1}", range.mean_mm),
            format!("{:.1} to {:.1}", range.low_mm, range.high_mm),
            format!("{:.1} %", 100.0 * prediction.best),
            format!("{:.1}", range.simulated_mm),
        ]
    });
    let head = ["best on the bench", "range mm", "80 % interval", "is the best", "simulated"];
    text += &text_table(1, head, best);
    text + &warnings(subject, result)
        .iter()
        .map(|words| format!("warning: {words}\n"))
        .collect::<String>()
}

/// Returns prior and posterior intervals of the parameters, within 80 columns.
pub fn parameters_text(calibration: &Calibration) -> String {
    let row = |Moved { name, task, prior, posterior, moved }: Moved| {
        let span = |[low, _, high]: [f64; 3]| format!("{low:.2} to {high:.2}");
        let name = task.map_or(name.clone(), |task| format!("{name} ({task})"));
        let moved = if moved { "yes" } else { "no" };
        [name, span(prior), span(posterior), moved.to_owned()]
    };
    let head = ["parameter (10 % to 90 %)", "before", "after", "moved"];
    let alike = together(calibration).into_iter().map(|(a, b, correlation)| {
        format!("not told apart: {a} and {b} (correlation {correlation:+.2})\n")
    });
    text_table(1, head, moved(calibration).into_iter().map(row)) + &alike.collect::<String>()
}
