//! Formatting of the designs, numbers and outcomes of answers, for terminal and page alike.

use calibration::next::BestMeasured;
use input::units::N_PER_MM;
use insertion::evaluation::{RobustRange, SuccessRate};
use insertion::outcome::STOP_REMEDY;
use insertion::{
    DENSITY_KEY, DIRECTION_KEY, Design, Estimate, Evaluation, FailureClass, Measure, Objectives,
    Outcome, Window,
};
use study::{Recorded, StudyConfig, StudyRecord};

/// Returns the number of evaluations after which the search settled (stopped early), and the criterion, in words.
pub fn settled(record: &StudyRecord) -> String {
    let (evaluations, gain_mm) = (record.evaluations.len(), record.config.indifference_mm);
    format!("after {evaluations} evaluations: no finger is expected to gain {gain_mm} mm")
}

/// Formats a range or another length with one decimal: `3.5 mm`.
pub fn mm(length_mm: f64) -> String {
    Measure::Range.show(length_mm)
}

/// Returns which finger to use now: the best measured one.
pub fn use_now(best: &BestMeasured) -> String {
    let rank = match best.fingers {
        1 => "the only measured finger".to_owned(),
        fingers => format!("the best of {fingers} measured fingers"),
    };
    format!("Use {} now: {rank}, {} on a robot", design(&best.design), measured(best))
}

/// Returns a measured range: `5.1 mm`, or `5.1 mm or more` of a lower bound.
pub fn measured(BestMeasured { range_mm, at_least, .. }: &BestMeasured) -> String {
    mm(*range_mm) + if *at_least { " or more" } else { "" }
}

/// Returns an interval of lengths: `3.1 to 3.5 mm`.
pub fn interval([low_mm, high_mm]: [f64; 2]) -> String {
    format!("{low_mm:.1} to {high_mm:.1} mm")
}

/// Returns ` on usb` for one of several tasks, else nothing.
pub fn on(config: &StudyConfig, task: &str) -> String {
    if config.several_tasks() { format!(" on {task}") } else { String::new() }
}

/// Returns both ends of a window without their unit: `-4.5 to +5.8`.
pub fn span([low_mm, high_mm]: [f64; 2]) -> String {
    format!("{low_mm:.1} to {high_mm:+.1}")
}

/// Returns both ends of a window, mm.
pub fn ends_mm(window: &Window) -> [f64; 2] {
    [window.negative_mm(), window.positive_mm()]
}

/// Table heading of the finger's stiffness in the compliance direction (y), as used in the trials.
pub const COMPLIANCE: &str = "compliance, measured model";

/// Returns a stiffness with its standard deviation, N/mm.
pub fn stiffness(estimate: Estimate) -> String {
    let (mean, sd) = (estimate.mean / N_PER_MM, estimate.sd / N_PER_MM);
    let digits = if mean >= 10.0 { 1 } else { 2 };
    format!("{mean:.digits$} ± {sd:.digits$} N/mm")
}

/// Returns a number with `decimals` decimals and its unit; `none` if it is not finite or too long.
pub fn number(value: f64, decimals: usize, unit: &str) -> String {
    let text = format!("{value:.decimals$}");
    // Too long: for example the position of a body that a collision threw far away.
    if !value.is_finite() || text.len() > 15 { "none".to_owned() } else { format!("{text} {unit}") }
}

/// Rounds a number to `decimals` decimals.
pub fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    // Adding 0 turns -0 into 0.
    (value * scale).round() / scale + 0.0
}

/// Returns the mating force, that of the connector's contact springs: `up to 12 N` or `none given`.
pub fn mating_force(largest: Option<f64>) -> String {
    largest.map_or("none given".to_owned(), |largest| format!("up to {}", number(largest, 1, "N")))
}

/// Returns an outcome in words, a failure with its class: `jammed (class 3)`.
pub fn outcome(outcome: Outcome) -> String {
    let class = outcome.failure().map_or(String::new(), |number| format!(" (class {number})"));
    format!("{}{class}", outcome.label())
}

/// Advice for a nominal start that diverges, then for each failure class.
const REMEDIES: [&str; 5] = [
    "Check the task's masses, shapes and strokes",
    "Check the grip's force and friction, and that the start is clear of the socket",
    "Check the task's start, and strokes and preload of its search: the plug misses the opening",
    "Check the clearance of plug and socket, the strokes, and the finger's remote centre",
    "Check the grip's force and friction against the force that the insertion needs",
];

/// Returns advice for a nominal start that ends with this outcome, as sentences without the last full stop. A plug that
/// misses is pressed on the rim, which stops a robot, too; a robot with a low limit stops before it finds the opening:
/// `by_robot`, if the start would insert without the stop.
pub fn remedy(nominal: Outcome, robot_stopped: bool, by_robot: bool) -> String {
    let own = REMEDIES[usize::from(nominal.failure().unwrap_or(0))];
    match (robot_stopped, nominal) {
        (true, Outcome::Failed(FailureClass::PlugMissed)) if !by_robot => {
            format!("{own}. {STOP_REMEDY}")
        }
        (true, _) => STOP_REMEDY.to_owned(),
        (false, _) => own.to_owned(),
    }
}

/// Returns the headline of a finger with which the robot stops in most insertions; `on` is ` on ` and the task, or empty.
pub fn not_usable(Evaluation { robot_stops, trials, .. }: &Evaluation, on: &str) -> String {
    format!("Not usable as it is: the robot stops in {robot_stops} of {trials} trials{on}")
}

/// Returns the outcome beyond an end of a window, in words; `None` if the search ended without a failure.
pub fn end(end: Option<Outcome>) -> String {
    end.map_or("no failure".to_owned(), outcome)
}

/// Returns the success rate of a design under random errors, and its failures by class, in words.
pub fn success(success: &SuccessRate) -> [String; 2] {
    let rate = success.max_rate().map_or("none".to_owned(), |rate| format!("{rate:.3}"));
    let [low, high] = success.interval();
    let [c1, c2, c3, c4] = success.failure_counts;
    let measured = match success.raced() {
        Some(draws) => format!("at most {rate}, raced after {draws} draws"),
        None => format!(
            "{rate}, {} % interval {low:.3} to {high:.3}: {} of {} trials",
            100.0 * success.confidence,
            success.inserted,
            success.counted()
        ),
    };
    [
        measured,
        format!("{c1} of class 1, {c2} of 2, {c3} of 3, {c4} of 4, {} diverged", success.diverged),
    ]
}

/// Returns the robust range, and number, mean and deviation of the ranges it was computed from, in words.
pub fn robust(robust: &RobustRange) -> String {
    let value = robust.value_mm.map_or("none".to_owned(), |mm| Measure::RobustRange.show(mm));
    let [mean, sd] = [robust.mean_mm(), robust.sd_mm()].map(|mm| number(mm, 2, "mm"));
    let (windows, diverged) = (robust.ranges_mm.len(), robust.diverged);
    format!("{value}: {windows} windows of mean {mean}, deviation {sd}, {diverged} diverged")
}

/// Returns a recorded design in words with its number: `10 % infill at 26° (evaluation 41)`.
pub fn evaluated(recorded: &Recorded) -> String {
    format!("{} (evaluation {})", design(&recorded.design), recorded.index)
}

/// Returns a design in words: `10 % infill at 26°`, then the other parameters of its space.
pub fn design(design: &Design) -> String {
    let infill = design.get(DENSITY_KEY).zip(design.get(DIRECTION_KEY));
    let Some((density, direction)) = infill else { return design.labelled() };
    let infill = format!("{density} % infill at {direction}°");
    let mut others = design.clone();
    others.0.retain(|key, _| ![DENSITY_KEY, DIRECTION_KEY].contains(&key.as_str()));
    if others.0.is_empty() { infill } else { format!("{infill}, {}", others.labelled()) }
}

/// Returns the probability that none of the listed fingers is the best, given theirs, and the number of the other
/// fingers, in words; `None` if all are listed.
pub fn others(listed: impl ExactSizeIterator<Item = f64>, of: usize) -> Option<String> {
    let left = of.checked_sub(listed.len()).filter(|left| *left > 0)?;
    let percent = 100.0 * (1.0 - listed.sum::<f64>()).max(0.0);
    Some(format!("{percent:.1} % spread over {left} others"))
}

/// Returns the values of objectives, with their names if there are several.
pub fn values(objectives: &Objectives, values: &[f64]) -> String {
    match (objectives.single(), values) {
        (Some(measure), [value]) => measure.show(*value),
        _ => objectives.show(values),
    }
}

/// Returns the unit of a hypervolume: `mm N`.
pub fn volume_unit(objectives: &Objectives) -> String {
    let units = objectives.measures().iter().map(|measure| measure.unit());
    units.filter(|unit| !unit.is_empty()).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fingers_not_listed_have_the_rest_of_the_probability() {
        let listed = || [0.15, 0.12].into_iter();
        assert_eq!(others(listed(), 43).as_deref(), Some("73.0 % spread over 41 others"));
        assert_eq!(others(listed(), 2), None);
    }
}
