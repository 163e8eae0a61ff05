//! Verdict on the predictions for a task, from their leave-one-out validation.

use input::counted;
use study::LeaveOneOut;

/// Smallest number of measured ranges that validate a prediction. Of five or more, fewer than half lie inside 80 %
/// intervals by chance in at most 6 % of the cases.
const ENOUGH: usize = 5;
/// Mean deviation of the leave-one-out predictions, percent, above which they are not reliable.
const MISSED: f64 = 50.0;
/// Rank correlation of the leave-one-out predictions below which the order is not predictable.
const ORDERED: f64 = 0.3;

/// Returns how many intervals contain the measured range, in words.
pub fn coverage(inside: usize, fingers: usize) -> String {
    match fingers {
        ..ENOUGH => format!("{}, too few to judge the 80 % intervals", counted(fingers, "finger")),
        _ => format!("{inside} of {fingers} in their 80 % interval"),
    }
}

/// Verdict on the predictions for a task.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Whether the predictions can be trusted within their intervals.
    pub reliable: bool,
    /// Advice with its reason, one sentence.
    pub text: String,
}

impl Verdict {
    /// Judges predictions by their accuracy and by the mean deviation, percent, of predicting each finger by the mean
    /// of the others.
    pub fn of(accuracy: &LeaveOneOut, others_percent: Option<f64>) -> Self {
        let LeaveOneOut { fingers, mean_deviation_percent, spearman, inside, .. } = *accuracy;
        let deviations = mean_deviation_percent.zip(others_percent);
        let better = deviations.is_some_and(|(own, others)| own < others && own <= MISSED);
        let ordered = better && spearman.is_some_and(|rank| rank >= ORDERED);
        let covered = 2 * inside >= fingers;
        let identify = "identify the cell from logs (`optimize identify`)";
        let advice = match (ENOUGH.saturating_sub(fingers), ordered, covered) {
            (0, true, true) => "trust these predictions within their intervals".to_owned(),
            (0, true, false) => format!(
                "trust the order of these predictions, not their intervals, which contain only {inside}"
            ),
            (0, false, _) => format!(
                "do not choose by these predictions: take the widest measured finger, or {identify}"
            ),
            (more, ..) => {
                format!("do not rely on these predictions yet: measure {more} more, or {identify}")
            }
        };
        let compared = deviations.map_or(String::new(), |(own, others)| {
            format!(
                ", left out in turn predicted {own:.0} % off on average, by the mean of the others {others:.0} %"
            )
        });
        let text = format!("{advice}; {}{compared}", counted(fingers, "measured range"));
        Verdict { reliable: fingers >= ENOUGH && ordered && covered, text }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(fingers: usize, own: f64, others: Option<f64>, inside: usize) -> Verdict {
        let accuracy = LeaveOneOut {
            fingers,
            mean_deviation_percent: Some(own),
            spearman: Some(0.8),
            inside,
            emulator_error_mm: 0.1,
        };
        Verdict::of(&accuracy, others)
    }

    #[test]
    fn intervals_of_fewer_than_five_fingers_are_not_judged() {
        assert_eq!(coverage(1, 1), "1 finger, too few to judge the 80 % intervals");
        assert_eq!(coverage(4, 4), "4 fingers, too few to judge the 80 % intervals");
        assert_eq!(coverage(4, 5), "4 of 5 in their 80 % interval");
    }

    #[test]
    fn predictions_are_judged_by_number_error_order_and_coverage() {
        let says = |found: Verdict, reliable: bool, words: &str| {
            assert_eq!((found.reliable, found.text.contains(words)), (reliable, true), "{found:?}");
        };
        says(verdict(2, 140.0, Some(64.0), 2), false, "yet: measure 3 more, or identify");
        says(verdict(2, 140.0, Some(64.0), 2), false, "2 measured ranges, left out in turn");
        says(verdict(1, 90.0, None, 0), false, "measure 4 more, or identify the cell from logs");
        says(verdict(11, 7.5, Some(18.7), 9), true, "trust these predictions within");
        says(
            verdict(11, 7.5, Some(18.7), 9),
            true,
            "8 % off on average, by the mean of the others 19 %",
        );
        says(verdict(11, 10.8, Some(8.9), 9), false, "take the widest measured finger");
        says(verdict(5, 60.0, Some(70.0), 5), false, "take the widest measured finger");
        says(verdict(7, 7.5, Some(18.7), 3), false, "not their intervals, which contain only 3");
        let unordered = LeaveOneOut {
            fingers: 6,
            mean_deviation_percent: Some(5.0),
            spearman: None,
            inside: 6,
            emulator_error_mm: 0.1,
        };
        says(Verdict::of(&unordered, Some(9.0)), false, "do not choose by these predictions");
    }
}
