//! Serialized form of an evaluation: its keys in JSON, in the journal of a study and in tables.

use super::{OffsetStep, RobustRange, SuccessRate, Window, grid_mm};
use crate::Outcome;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[derive(Serialize, Deserialize)]
pub(super) struct WindowRow {
    range_mm: f64,
    negative_mm: f64,
    positive_mm: f64,
    /// Outcome at the nominal start, without a failure class: if it failed, both ends contain its class.
    nominal: String,
    failure_negative: Option<Outcome>,
    failure_positive: Option<Outcome>,
}

impl From<Window> for WindowRow {
    fn from(window: Window) -> Self {
        WindowRow {
            range_mm: window.range_mm(),
            negative_mm: window.negative_mm(),
            positive_mm: window.positive_mm(),
            nominal: window.nominal.word().to_owned(),
            failure_negative: window.end_negative,
            failure_positive: window.end_positive,
        }
    }
}

impl TryFrom<WindowRow> for Window {
    type Error = String;

    fn try_from(row: WindowRow) -> Result<Self, String> {
        let nominal = match &*row.nominal {
            "inserted" => Outcome::Inserted,
            "diverged" => Outcome::Diverged,
            // Both ends of an empty window have the outcome of the nominal start.
            "failed" => row.failure_negative.ok_or("`failed` without failure_negative")?,
            other => return Err(format!("is `{other}`; accepted: inserted, failed, diverged")),
        };
        Ok(Window {
            nominal,
            negative_steps: steps(row.negative_mm),
            positive_steps: steps(row.positive_mm),
            end_negative: row.failure_negative,
            end_positive: row.failure_positive,
        })
    }
}

/// Limit to which deserialized grid steps are clamped: beyond any window, and small enough for sums.
const MAX_STEPS: f64 = 1e8;

fn steps(mm: f64) -> OffsetStep {
    (mm / grid_mm(1)).round().clamp(-MAX_STEPS, MAX_STEPS) as OffsetStep
}

/// Serializes grid steps as mm.
pub fn taught_mm<S: Serializer>(taught: &Option<OffsetStep>, to: S) -> Result<S::Ok, S::Error> {
    taught.map(grid_mm).serialize(to)
}

/// Deserializes mm as grid steps.
pub fn taught_steps<'de, D: Deserializer<'de>>(from: D) -> Result<Option<OffsetStep>, D::Error> {
    Ok(Option::deserialize(from)?.map(steps))
}

/// Success rate and its interval, and the counts from which they are computed.
#[derive(Serialize)]
struct SuccessRow<'a> {
    success_rate: Option<f64>,
    success_low: Option<f64>,
    success_high: Option<f64>,
    /// Upper bound of the rate if a [`Race`](super::robustness::race::Race) stopped the evaluation early; there is no
    /// rate or interval then.
    success_at_most: Option<f64>,
    /// Number of draws tried before the race stopped the evaluation.
    raced_draws: Option<u32>,
    #[serde(flatten)]
    counts: &'a SuccessRate,
}

/// Serializes counts together with their rate and interval.
pub fn with_rate<S: Serializer>(rate: &Option<SuccessRate>, to: S) -> Result<S::Ok, S::Error> {
    let row = rate.as_ref().map(|counts| {
        let raced_draws = counts.raced();
        let is_raced = raced_draws.is_some();
        let [success_low, success_high] = counts.interval().map(|end| (!is_raced).then_some(end));
        let success_at_most = counts.max_rate().filter(|_| is_raced);
        let success_rate = counts.rate();
        SuccessRow { success_rate, success_low, success_high, success_at_most, raced_draws, counts }
    });
    row.serialize(to)
}

#[derive(Serialize)]
struct RobustRow<'a> {
    robust_range_mm: Option<f64>,
    robust_mean_mm: f64,
    robust_sd_mm: f64,
    robust_windows: usize,
    #[serde(flatten)]
    ranges: &'a RobustRange,
}

/// Serializes ranges together with their mean and standard deviation.
pub fn with_spread<S: Serializer>(robust: &Option<RobustRange>, to: S) -> Result<S::Ok, S::Error> {
    let row = robust.as_ref().map(|ranges| RobustRow {
        robust_range_mm: ranges.value_mm,
        robust_mean_mm: ranges.mean_mm(),
        robust_sd_mm: ranges.sd_mm(),
        robust_windows: ranges.ranges_mm.len(),
        ranges,
    });
    row.serialize(to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::Evaluation;
    use crate::evaluation::tests::{ranges, success};
    use crate::outcome::FailureClass;
    use serde_json::Value;

    fn evaluation() -> Evaluation {
        let window = Window {
            nominal: Outcome::Inserted,
            negative_steps: -33,
            positive_steps: 14,
            end_negative: Some(Outcome::Diverged),
            end_positive: Some(Outcome::Failed(FailureClass::PlugMissed)),
        };
        Evaluation {
            failure_counts: [0, 1, 0, 0],
            diverged: 1,
            trials: 20,
            peak_force_n: 0.1 + 0.2,
            slip_mm: 0.3,
            simulated_s: 12.5,
            ..Evaluation::of(window, [0.25, 1.0 / 3.0])
        }
    }

    fn round_trip(evaluation: &Evaluation) -> Evaluation {
        serde_json::from_str(&serde_json::to_string(evaluation).unwrap()).unwrap()
    }

    #[test]
    fn an_evaluation_reads_back_as_the_same_bits() {
        let plain = evaluation();
        assert_eq!(round_trip(&plain), plain);
        let missed = Some(Outcome::Failed(FailureClass::PlugMissed));
        let mut full = evaluation();
        full.window.nominal = Outcome::Failed(FailureClass::PlugMissed);
        (full.window.negative_steps, full.window.positive_steps) = (0, 0);
        (full.window.end_negative, full.window.end_positive) = (missed, missed);
        full.success = Some(success(3, 2));
        full.robust = Some(RobustRange { diverged: 2, trials: 7, ..ranges(vec![1.1]) });
        assert_eq!(round_trip(&full), full);
        full.taught = Some(-13);
        assert_eq!(round_trip(&full), full);
        let raced = SuccessRate { skipped: 95, failed_draws: vec![2, 7], ..success(3, 2) };
        full.success = Some(raced);
        assert_eq!(round_trip(&full), full);
        let value = serde_json::to_value(&full).unwrap();
        assert_eq!((&value["success_rate"], &value["success_high"]), (&Value::Null, &Value::Null));
        assert_eq!((&value["success_at_most"], &value["raced_draws"]), (&0.98.into(), &8.into()));
        let mut limit = evaluation();
        (limit.window.end_negative, limit.window.end_positive) = (None, None);
        assert_eq!(round_trip(&limit), limit);
    }

    #[test]
    fn a_failure_without_its_class_is_rejected() {
        let mut value = serde_json::to_value(evaluation()).unwrap();
        value["nominal"] = "failed".into();
        value["failure_negative"] = serde_json::Value::Null;
        assert!(serde_json::from_value::<Evaluation>(value).is_err());
    }
}
