//! Results of window searches and evaluations.

pub mod cell;
pub mod evaluator;
pub mod objective;
pub mod robustness;
mod schema;
mod shape_correction;
pub mod taught;
pub mod template;
pub mod tolerance;
pub mod uncertainty;

use crate::Outcome;
use crate::surrogate::null_is_nan;
use ask_tell::statistics::{Moments, normal_quantile};
use serde::{Deserialize, Serialize};

/// Indifference zone of ranges, mm: a bench does not resolve smaller differences. Measured windows of the paper
/// differ by 0.1 to 0.5 mm.
pub const INDIFFERENCE_MM: f64 = 0.3;

/// Shift of the start along y, in grid steps of 0.1 mm.
pub type OffsetStep = i32;

/// Spacing of the offset grid, mm, as in the paper.
pub const OFFSET_STEP_MM: f64 = 0.1;

/// Tolerance window: offsets about the nominal start that insert, and the outcome beyond each end.
///
/// Invariant of a window with `nominal == Inserted`: `negative_steps <= 0 <= positive_steps`, and the trials at both
/// inserted. [`Search::Walk`](tolerance::Search::Walk) tries every grid offset between them;
/// [`Search::Strides`](tolerance::Search::Strides) misses gaps between the offsets that it tries.
///
/// ```
/// use insertion::{evaluation::Window, outcome::Outcome};
/// let nominal = Outcome::Inserted;
/// let (end_negative, end_positive) = (Some(Outcome::Diverged), None);
/// let window = Window { nominal, negative_steps: -33, positive_steps: 14, end_negative, end_positive };
/// assert_eq!(window.range_mm(), 4.7);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(into = "schema::WindowRow", try_from = "schema::WindowRow")]
pub struct Window {
    /// Outcome at the nominal start; unless it is inserted, the range is 0.
    pub nominal: Outcome,
    /// Most negative inserting offset, in grid steps.
    pub negative_steps: OffsetStep,
    /// Most positive inserting offset, in grid steps.
    pub positive_steps: OffsetStep,
    /// Outcome of the first failing offset below `negative_steps`; `None` at the search's limit.
    pub end_negative: Option<Outcome>,
    /// Outcome of the first failing offset above `positive_steps`.
    pub end_positive: Option<Outcome>,
}

impl Window {
    /// Returns the width in mm; 0 if the nominal start fails.
    pub fn range_mm(&self) -> f64 {
        if self.nominal != Outcome::Inserted {
            return 0.0;
        }
        // Deserialized windows are not trusted.
        grid_mm(self.positive_steps.saturating_sub(self.negative_steps))
    }

    /// Returns the most negative inserting offset in mm (0 or below).
    pub fn negative_mm(&self) -> f64 {
        grid_mm(self.negative_steps)
    }

    /// Returns the most positive inserting offset in mm (0 or above).
    pub fn positive_mm(&self) -> f64 {
        grid_mm(self.positive_steps)
    }
}

/// Returns a number of grid steps in mm, without the rounding noise of `n * 0.1`.
pub fn grid_mm(steps: OffsetStep) -> f64 {
    f64::from(steps) / 10.0
}

/// Evaluation of one design on one task; counts and times are those of the window search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Tolerance window around the nominal start.
    #[serde(flatten)]
    pub window: Window,
    /// Trials that failed with class 1 to 4, over all trials run.
    pub failure_counts: [u32; 4],
    /// Trials that diverged numerically.
    pub diverged: u32,
    /// Trials that a protective stop of the robot ended, whatever their outcome.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub robot_stops: u32,
    /// Largest contact force between plug and socket over the inserted trials, N; NaN if none inserted.
    #[serde(deserialize_with = "null_is_nan")]
    pub peak_force_n: f64,
    /// Largest slip of the part in the grasp over the inserted trials, mm; NaN if none
    /// inserted.
    #[serde(deserialize_with = "null_is_nan")]
    pub slip_mm: f64,
    /// Trials of the window search.
    pub trials: u32,
    /// Simulated time over all trials, s.
    #[serde(deserialize_with = "null_is_nan")]
    pub simulated_s: f64,
    /// Position of the outcome change in the grid step beyond each end (negative, positive), as a share of the step,
    /// 0 to 1, interpolated over [`Trial::margin`](crate::trial::Trial::margin). If the nominal start fails, both are
    /// its margin, -1 to 0.
    pub end_shares: [f64; 2],
    /// Shift of the taught start from the start in the task file, in grid steps; `None` without a taught start.
    #[serde(rename = "taught_start_mm", default, skip_serializing_if = "Option::is_none")]
    #[serde(serialize_with = "schema::taught_mm", deserialize_with = "schema::taught_steps")]
    pub taught: Option<OffsetStep>,
    /// Success rate under sampled errors, if measured.
    #[serde(flatten, serialize_with = "schema::with_rate")]
    pub success: Option<SuccessRate>,
    /// Range under sampled errors, if measured.
    #[serde(flatten, serialize_with = "schema::with_spread")]
    pub robust: Option<RobustRange>,
}

/// Outcomes of trials under sampled errors.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SuccessRate {
    /// Confidence level of [`interval`](Self::interval), 0 to 1.
    #[serde(rename = "success_confidence")]
    pub confidence: f64,
    /// Trials that ended inserted.
    #[serde(rename = "success_inserted")]
    pub inserted: u32,
    /// Trials that failed with class 1 to 4.
    #[serde(rename = "success_failure_counts")]
    pub failure_counts: [u32; 4],
    /// Trials that diverged; the rate excludes them.
    #[serde(rename = "success_diverged")]
    pub diverged: u32,
    /// Indices of the draws that failed, ascending; empty if not recorded.
    #[serde(rename = "success_failed_draws", default, skip_serializing_if = "Vec::is_empty")]
    pub failed_draws: Vec<u32>,
    /// Draws skipped because the [`Race`](robustness::race::Race) was lost before them.
    #[serde(rename = "success_spared_draws", default, skip_serializing_if = "is_zero")]
    pub skipped: u32,
}

impl Evaluation {
    /// Returns whether a protective stop of the robot made the nominal start fail.
    pub fn nominal_stop(&self) -> bool {
        self.window.nominal != Outcome::Inserted && self.robot_stops > 0
    }

    /// Returns the least number of insertions that a protective stop of the robot ended, and of all insertions: failures
    /// may stop it, too.
    pub fn stopped_insertions(&self) -> [u32; 2] {
        let failures = self.failure_counts.iter().sum();
        let insertions = self.trials.saturating_sub(failures + self.diverged);
        [self.robot_stops.saturating_sub(failures), insertions]
    }

    /// Returns whether a protective stop of the robot ended most insertions, although the nominal start inserts.
    pub fn mostly_stopped(&self) -> bool {
        let [stopped, insertions] = self.stopped_insertions();
        self.window.nominal == Outcome::Inserted && stopped > insertions / 2
    }
}

fn is_zero(count: &u32) -> bool {
    *count == 0
}

impl SuccessRate {
    /// Returns the number of trials that inserted or failed.
    pub fn counted(&self) -> u32 {
        let failed = self.failure_counts.iter();
        failed.fold(self.inserted, |sum, &count| sum.saturating_add(count))
    }

    /// Counts the outcome of one of the remaining draws.
    fn count(&mut self, draw: u32, outcome: Outcome) {
        self.skipped = self.skipped.saturating_sub(1);
        match outcome {
            Outcome::Inserted => self.inserted += 1,
            Outcome::Diverged => self.diverged += 1,
            Outcome::Failed(class) => {
                self.failure_counts[class as usize] += 1;
                self.failed_draws.push(draw);
            }
        }
    }

    /// Returns the number of draws that were tried.
    pub fn tried(&self) -> u32 {
        self.counted().saturating_add(self.diverged)
    }

    /// Returns the number of draws that were tried; `None` if no draw was skipped.
    pub fn raced(&self) -> Option<u32> {
        (self.skipped > 0).then(|| self.tried())
    }

    /// Returns the share of the counted trials that inserted, 0 to 1; `None` if there are none or draws were skipped.
    pub fn rate(&self) -> Option<f64> {
        self.max_rate().filter(|_| self.skipped == 0)
    }

    /// Returns the rate if all skipped draws inserted, an upper bound; `None` without counted or skipped draws.
    pub fn max_rate(&self) -> Option<f64> {
        let [inserted, counted] =
            [self.inserted, self.counted()].map(|n| f64::from(n) + f64::from(self.skipped));
        (counted > 0.0).then(|| inserted / counted)
    }

    /// Returns Wilson's score interval of the true rate (1927, J. Am. Stat. Assoc. 22:209). It is 0 to 1 if there is
    /// no rate, as after a lost race, whose draws are not a random sample.
    pub fn interval(&self) -> [f64; 2] {
        let Some(rate) = self.rate() else { return [0.0, 1.0] };
        let n = f64::from(self.counted());
        let z = normal_quantile(0.5 + self.confidence / 2.0);
        let centre = (rate + z * z / (2.0 * n)) / (1.0 + z * z / n);
        let half = z / (1.0 + z * z / n) * (rate * (1.0 - rate) / n + z * z / (4.0 * n * n)).sqrt();
        [(centre - half).max(0.0), (centre + half).min(1.0)]
    }
}

/// Ranges of one design under sampled errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobustRange {
    /// Range of each sample, mm, without the samples whose nominal start diverged.
    #[serde(rename = "robust_ranges_mm")]
    pub ranges_mm: Vec<f64>,
    /// Samples whose nominal start diverged.
    #[serde(rename = "robust_diverged")]
    pub diverged: u32,
    /// Number of trials of all windows.
    #[serde(rename = "robust_trials")]
    pub trials: u32,
    /// Mean minus a number of standard deviations, mm; `None` with fewer than two ranges.
    #[serde(rename = "robust_range_mm", skip_serializing)]
    pub value_mm: Option<f64>,
}

impl RobustRange {
    /// Returns the mean of the ranges, mm; NaN if there are none.
    pub fn mean_mm(&self) -> f64 {
        Moments::of(&self.ranges_mm).mean
    }

    /// Returns the standard deviation of the ranges (with n - 1), mm; NaN for fewer than two.
    pub fn sd_mm(&self) -> f64 {
        Moments::of(&self.ranges_mm).sample_deviation()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub fn ranges(ranges_mm: Vec<f64>) -> RobustRange {
        RobustRange { ranges_mm, diverged: 0, value_mm: None, trials: 0 }
    }

    pub fn success(inserted: u32, failed: u32) -> SuccessRate {
        let failure_counts = [0, 0, failed, 0];
        SuccessRate {
            inserted,
            failure_counts,
            diverged: 3,
            confidence: 0.95,
            ..Default::default()
        }
    }

    /// The formula worked apart, to seven digits.
    #[test]
    fn the_interval_is_wilsons() {
        for (inserted, failed, low, high) in [
            (87, 13, 0.790_196_5, 0.922_428_3),
            (0, 10, 0.0, 0.277_532_8),
            (10, 0, 0.722_467_2, 1.0),
        ] {
            let [a, b] = success(inserted, failed).interval();
            assert!((a - low).abs() < 1e-7 && (b - high).abs() < 1e-7, "[{a}, {b}]");
        }
        assert_eq!(success(0, 0).interval(), [0.0, 1.0]);
        assert_eq!(success(0, 0).rate(), None);
        assert_eq!(success(3, 1).rate(), Some(0.75));
        let raced = SuccessRate { skipped: 4, ..success(3, 1) };
        assert_eq!((raced.rate(), raced.max_rate(), raced.raced()), (None, Some(0.875), Some(7)));
        assert_eq!(raced.interval(), [0.0, 1.0]);
    }

    #[test]
    fn the_spread_of_ranges() {
        let robust = ranges(vec![3.0, 5.0, 7.0]);
        assert_eq!((robust.mean_mm(), robust.sd_mm()), (5.0, 2.0));
    }
}
