//! The one form in which an evaluation leaves the program: JSON, journal and tables have
//! these keys.

use super::{Evaluation, RobustRange, SuccessRate, Window, grid_mm};
use crate::outcome::{FailureClass, Outcome};
use serde::{Deserialize, Deserializer, Serialize};

/// An [`Evaluation`] as flat keys.
#[derive(Serialize, Deserialize)]
pub(super) struct EvaluationRow {
    range_mm: f64,
    negative_mm: f64,
    positive_mm: f64,
    nominal: OutcomeWord,
    failure_negative: Option<FailureWord>,
    failure_positive: Option<FailureWord>,
    failure_counts: [u32; 4],
    diverged: u32,
    #[serde(deserialize_with = "null_is_nan")]
    peak_force_n: f64,
    #[serde(deserialize_with = "null_is_nan")]
    slip_mm: f64,
    trials: u32,
    #[serde(deserialize_with = "null_is_nan")]
    simulated_s: f64,
    end_shares: [f64; 2],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    taught_start_mm: Option<f64>,
    #[serde(flatten)]
    success: Option<SuccessRow>,
    #[serde(flatten)]
    robust: Option<RobustRow>,
}

/// An outcome without its class.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum OutcomeWord {
    Inserted,
    Failed,
    Diverged,
}

/// Outcome that ended the search at one side: the failure class, 1 to 4, or `diverged`.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum FailureWord {
    Class(FailureClass),
    Other(OutcomeWord),
}

/// Success rate with its interval, for readers outside, and the counts they follow from.
#[derive(Serialize, Deserialize)]
struct SuccessRow {
    success_rate: Option<f64>,
    success_low: f64,
    success_high: f64,
    #[serde(flatten)]
    counts: SuccessRate,
}

#[derive(Serialize, Deserialize)]
struct RobustRow {
    robust_range_mm: Option<f64>,
    robust_mean_mm: Option<f64>,
    robust_sd_mm: Option<f64>,
    robust_windows: usize,
    #[serde(flatten)]
    ranges: RobustRange,
}

/// JSON has no NaN: it is written as null.
fn null_is_nan<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

impl From<Outcome> for OutcomeWord {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Inserted => OutcomeWord::Inserted,
            Outcome::Failed(_) => OutcomeWord::Failed,
            Outcome::Diverged => OutcomeWord::Diverged,
        }
    }
}

impl From<Outcome> for FailureWord {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Failed(class) => FailureWord::Class(class),
            other => FailureWord::Other(other.into()),
        }
    }
}

impl FailureWord {
    fn outcome(&self) -> Result<Outcome, String> {
        match self {
            FailureWord::Class(class) => Ok(Outcome::Failed(*class)),
            FailureWord::Other(OutcomeWord::Inserted) => Ok(Outcome::Inserted),
            FailureWord::Other(OutcomeWord::Diverged) => Ok(Outcome::Diverged),
            FailureWord::Other(OutcomeWord::Failed) => Err("a failure without its class".into()),
        }
    }
}

impl From<Evaluation> for EvaluationRow {
    fn from(evaluation: Evaluation) -> Self {
        let window = &evaluation.window;
        EvaluationRow {
            range_mm: window.range_mm(),
            negative_mm: window.negative_mm(),
            positive_mm: window.positive_mm(),
            nominal: window.nominal.into(),
            failure_negative: window.end_negative.map(FailureWord::from),
            failure_positive: window.end_positive.map(FailureWord::from),
            failure_counts: evaluation.failure_counts,
            diverged: evaluation.diverged,
            peak_force_n: evaluation.peak_force_n,
            slip_mm: evaluation.slip_mm,
            trials: evaluation.trials,
            simulated_s: evaluation.simulated_s,
            // A share that is no number would not be read again.
            end_shares: evaluation
                .end_shares
                .map(|share| if share.is_finite() { share } else { 0.0 }),
            taught_start_mm: evaluation.taught.map(grid_mm),
            success: evaluation.success.map(SuccessRow::from),
            robust: evaluation.robust.map(RobustRow::from),
        }
    }
}

impl TryFrom<EvaluationRow> for Evaluation {
    type Error = String;

    fn try_from(row: EvaluationRow) -> Result<Self, String> {
        let end = |failure: &Option<FailureWord>| failure.as_ref().map(FailureWord::outcome);
        let end_negative = end(&row.failure_negative).transpose()?;
        let nominal = match row.nominal {
            OutcomeWord::Inserted => Outcome::Inserted,
            OutcomeWord::Diverged => Outcome::Diverged,
            // A window that is empty ends as its nominal start does.
            OutcomeWord::Failed => end_negative.ok_or("a nominal failure without its class")?,
        };
        let steps = |mm: f64| (mm / grid_mm(1)).round() as i32;
        Ok(Evaluation {
            window: Window {
                nominal,
                negative_steps: steps(row.negative_mm),
                positive_steps: steps(row.positive_mm),
                end_negative,
                end_positive: end(&row.failure_positive).transpose()?,
            },
            failure_counts: row.failure_counts,
            diverged: row.diverged,
            trials: row.trials,
            peak_force_n: row.peak_force_n,
            slip_mm: row.slip_mm,
            simulated_s: row.simulated_s,
            end_shares: row.end_shares,
            taught: row.taught_start_mm.map(steps),
            success: row.success.map(|row| row.counts),
            robust: row
                .robust
                .map(|row| RobustRange { value_mm: row.robust_range_mm, ..row.ranges }),
        })
    }
}

impl From<SuccessRate> for SuccessRow {
    fn from(counts: SuccessRate) -> Self {
        let [success_low, success_high] = counts.interval();
        SuccessRow { success_rate: counts.rate(), success_low, success_high, counts }
    }
}

impl From<RobustRange> for RobustRow {
    fn from(robust: RobustRange) -> Self {
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        RobustRow {
            robust_range_mm: robust.value_mm,
            robust_mean_mm: finite(robust.mean_mm()),
            robust_sd_mm: finite(robust.sd_mm()),
            robust_windows: robust.ranges_mm.len(),
            ranges: robust,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    fn again(evaluation: &Evaluation) -> Evaluation {
        serde_json::from_str(&serde_json::to_string(evaluation).unwrap()).unwrap()
    }

    #[test]
    fn an_evaluation_reads_back_as_the_same_bits() {
        let plain = evaluation();
        assert_eq!(again(&plain), plain);
        let missed = Some(Outcome::Failed(FailureClass::PlugMissed));
        let mut full = evaluation();
        full.window.nominal = Outcome::Failed(FailureClass::PlugMissed);
        (full.window.negative_steps, full.window.positive_steps) = (0, 0);
        (full.window.end_negative, full.window.end_positive) = (missed, missed);
        full.success = Some(SuccessRate {
            inserted: 3,
            failure_counts: [1, 0, 2, 0],
            diverged: 1,
            confidence: 0.95,
        });
        full.robust =
            Some(RobustRange { ranges_mm: vec![1.1], diverged: 2, value_mm: None, trials: 7 });
        assert_eq!(again(&full), full);
        full.taught = Some(-13);
        assert_eq!(again(&full), full);
        let mut limit = evaluation();
        (limit.window.end_negative, limit.window.end_positive) = (None, None);
        assert_eq!(again(&limit), limit);
    }

    #[test]
    fn the_keys_carry_their_units_and_an_end_its_class() {
        let value = serde_json::to_value(evaluation()).unwrap();
        assert_eq!((&value["range_mm"], &value["nominal"]), (&4.7.into(), &"inserted".into()));
        assert_eq!(value["failure_negative"], "diverged");
        assert_eq!(value["failure_positive"], 2);
        assert_eq!(value.get("success_rate"), None);
    }

    #[test]
    fn what_contradicts_itself_is_refused() {
        let mut value = serde_json::to_value(evaluation()).unwrap();
        value["nominal"] = "failed".into();
        value["failure_negative"] = serde_json::Value::Null;
        assert!(serde_json::from_value::<Evaluation>(value).is_err());
    }
}
