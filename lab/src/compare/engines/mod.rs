//! Check T9 of `docs/notes/simulation.md`: the same trials in two engines.
//!
//! Two engines without common contact code should agree on the outcomes of the same trials. Trials of the softest and
//! the stiffest measured finger on every task start at fixed distances inside and outside of both ends of the first
//! engine's window, and in its middle.

#[cfg(test)]
mod tests;

use super::pairs::{self, WindowPair};
use super::{Setting, Subject, TaskSettings, each};
use ask_tell::statistics::{mean, quantile, sorted};
use insertion::evaluation::tolerance;
use insertion::{Grasp, Measurement, OffsetStep, Outcome, Trial, Window, grid_mm};
use report::text_table;
use std::collections::BTreeSet;

/// Smallest accepted fraction of the trials on which the engines agree.
pub const AGREEMENT: f64 = 0.9;
/// Largest accepted mean difference of the windows' ends, mm.
pub const END_DIFFERENCE_MM: f64 = 0.5;

/// Returns the offsets of the trials about a window, grid steps; if `reduced`, a few far from the ends.
pub fn offsets(window: &Window, reduced: bool) -> Vec<OffsetStep> {
    let [inside, outside]: [&[OffsetStep]; 2] = match reduced {
        false => [&[1, 3, 10, 20], &[1, 3, 10, 20, 40]],
        true => [&[10], &[20]],
    };
    let (low, high) = (window.negative_steps, window.positive_steps);
    let near = inside.iter().filter(|&by| 2 * by <= high - low);
    let inner = near.flat_map(|by| [low + by, high - by]);
    let outer = outside.iter().flat_map(|by| [low - by, high + by]);
    // A set, since two offsets may be equal.
    let all: BTreeSet<_> = inner.chain(outer).chain([(low + high).div_euclid(2)]).collect();
    all.into_iter().collect()
}

/// Outcomes of a trial in both engines.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialPair {
    pub subject: Subject,
    pub offset: OffsetStep,
    /// Distance beyond the nearer end of the first engine's window, grid steps; negative inside.
    pub from_end: OffsetStep,
    pub outcomes: [Outcome; 2],
    /// Distance between the final positions of the plug's tip, mm, if both inserted.
    pub tip_mm: Option<f64>,
}

impl TrialPair {
    /// Returns whether both inserted the plug, or neither.
    pub fn agrees(&self) -> bool {
        let [first, second] = self.outcomes.map(|outcome| outcome == Outcome::Inserted);
        first == second
    }
}

/// Result of check T9.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossCheck {
    pub trials: Vec<TrialPair>,
    pub windows: Vec<WindowPair>,
}

impl CrossCheck {
    /// Returns the fraction of the trials on which the engines agree, 0 to 1.
    pub fn agreement(&self) -> f64 {
        self.trials.iter().filter(|pair| pair.agrees()).count() as f64 / self.trials.len() as f64
    }

    /// Returns the mean difference of the windows' ends, mm; `None` without windows.
    pub fn end_difference_mm(&self) -> Option<f64> {
        mean(self.windows.iter().flat_map(WindowPair::moved_mm).map(f64::abs))
    }

    pub fn passed(&self) -> bool {
        self.agreement() >= AGREEMENT
            && self.end_difference_mm().is_none_or(|by| by <= END_DIFFERENCE_MM)
    }
}

/// Compares both settings of every task; if `reduced`, by few trials and without the second window.
pub fn run(tasks: &[TaskSettings], designs: &[Measurement], reduced: bool) -> CrossCheck {
    let results = each(tasks, designs, |subject, settings| in_both(subject, settings, reduced));
    let results = results.into_iter().map(|result| (result.trials, result.windows));
    let (trials, windows): (Vec<_>, Vec<_>) = results.unzip();
    CrossCheck { trials: trials.concat(), windows: windows.concat() }
}

/// Compares both settings by the trials of a finger.
fn in_both(subject: &Subject, settings: &[Setting; 2], reduced: bool) -> CrossCheck {
    let reference = settings[0].evaluate(&subject.finger);
    let window = &reference.window;
    let grasped = settings.each_ref().map(|setting| setting.rig.grasp(Grasp::of(&subject.finger)));
    let trial = |offset: OffsetStep| {
        let trials = grasped.each_ref().map(|grasped| grasped.trial(tolerance::offset(offset)));
        TrialPair {
            subject: subject.clone(),
            offset,
            from_end: (window.negative_steps - offset).max(offset - window.positive_steps),
            outcomes: trials.each_ref().map(|trial| trial.outcome),
            tip_mm: tip_distance(&trials),
        }
    };
    let trials = offsets(window, reduced).into_iter().map(trial).collect();
    let pair =
        || WindowPair::new(subject, settings, [&reference, &settings[1].evaluate(&subject.finger)]);
    CrossCheck { trials, windows: (!reduced).then(pair).into_iter().collect() }
}

/// Returns the distance between the final positions of the plug's tip, mm; `None` unless both inserted.
fn tip_distance(trials: &[Trial; 2]) -> Option<f64> {
    let tip = |trial: &Trial| match trial.outcome {
        Outcome::Inserted => trial.phases.last().map(|end| end.tip_mm),
        _ => None,
    };
    let [a, b] = trials.each_ref().map(tip);
    let square: f64 = a?.iter().zip(b?).map(|(a, b)| (a - b) * (a - b)).sum();
    Some(square.sqrt())
}

/// Returns tables and verdicts for the terminal.
pub fn text(check: &CrossCheck, [first, second]: [&str; 2]) -> String {
    let verdict = |met| if met { "met" } else { "MISSED" };
    let mut text = format!("T9: the same trials in {first} and {second}\n\n");
    if let Some(mean) = check.end_difference_mm() {
        text += &pairs::text(&check.windows, None);
        text += &format!(
            "mean difference of an end {mean:.2} mm; target {END_DIFFERENCE_MM} mm: {}\n\n",
            verdict(mean <= END_DIFFERENCE_MM)
        );
    }
    let others: Vec<&TrialPair> = check.trials.iter().filter(|pair| !pair.agrees()).collect();
    let total = check.trials.len();
    let [share, target] = [check.agreement(), AGREEMENT].map(|share| 100.0 * share);
    text += &format!(
        "alike in {} of {total} trials, {share:.1} %; target {target:.0} %: {}\n",
        total - others.len(),
        verdict(check.agreement() >= AGREEMENT)
    );
    let tips = sorted(check.trials.iter().filter_map(|pair| pair.tip_mm));
    let count = tips.len();
    if let (Some(median), Some(largest)) = (quantile(&tips, 0.5), tips.last()) {
        text += &format!(
            "tips of the {count} plugs that both insert: {median:.3} mm apart (median), {largest:.3} mm at most\n"
        );
    }
    if others.is_empty() {
        return text;
    }
    let rows = others.into_iter().map(|pair| {
        let [a, b] = pair.outcomes.map(|outcome| outcome.label().to_owned());
        let [offset, beyond] = [pair.offset, pair.from_end].map(grid_mm);
        let [offset, beyond] = [offset, beyond].map(|mm| format!("{mm:.1}"));
        [pair.subject.task.to_string(), pair.subject.infill(), offset, beyond, a, b]
    });
    let head = ["task", "finger", "offset mm", "beyond end mm", first, second];
    text + "\n" + &text_table(2, head, rows)
}
