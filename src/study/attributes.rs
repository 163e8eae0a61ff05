//! What a journal line says of an evaluation beyond what Optuna has fields for.

use crate::evaluation::{Evaluation, RobustRange, SuccessRate, Window, grid_mm};
use crate::outcome::Outcome;
use crate::surrogate::{Estimate, Prediction};
use serde::{Deserialize, Deserializer, Serialize};

/// User attributes of a trial.
#[derive(Serialize, Deserialize)]
pub struct Attributes {
    #[serde(flatten)]
    measured: MeasuredLine,
    stiffness: StiffnessLine,
    #[serde(deserialize_with = "null_is_nan")]
    hull_distance: f64,
    #[serde(flatten)]
    drawn: DrawnLine,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    other_tasks: Vec<TaskLine>,
}

/// The evaluation on a task beside the first one.
#[derive(Serialize, Deserialize)]
struct TaskLine {
    #[serde(flatten)]
    measured: MeasuredLine,
    #[serde(flatten)]
    drawn: DrawnLine,
}

/// What the window search measured.
#[derive(Serialize, Deserialize)]
struct MeasuredLine {
    window: WindowLine,
    failure_counts: [u32; 4],
    diverged: u32,
    trials: u32,
    #[serde(deserialize_with = "null_is_nan")]
    peak_force_n: f64,
    #[serde(deserialize_with = "null_is_nan")]
    slip_mm: f64,
    #[serde(deserialize_with = "null_is_nan")]
    simulated_s: f64,
    /// Studies from before it was recorded have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    end_shares: Option<[f64; 2]>,
}

/// What was measured under drawn errors.
#[derive(Serialize, Deserialize)]
struct DrawnLine {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    success_rate: Option<SuccessLine>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    robust_range: Option<RobustLine>,
}

/// The counts, and for other readers what follows from them.
#[derive(Serialize, Deserialize)]
struct SuccessLine {
    rate: Option<f64>,
    interval: [f64; 2],
    confidence: f64,
    inserted: u32,
    failure_counts: [u32; 4],
    diverged: u32,
}

impl From<&SuccessRate> for SuccessLine {
    fn from(success: &SuccessRate) -> Self {
        SuccessLine {
            rate: success.rate(),
            interval: success.interval(),
            confidence: success.confidence,
            inserted: success.inserted,
            failure_counts: success.failure_counts,
            diverged: success.diverged,
        }
    }
}

impl From<&SuccessLine> for SuccessRate {
    fn from(line: &SuccessLine) -> Self {
        SuccessRate {
            inserted: line.inserted,
            failure_counts: line.failure_counts,
            diverged: line.diverged,
            confidence: line.confidence,
        }
    }
}

#[derive(Serialize, Deserialize)]
struct RobustLine {
    value_mm: Option<f64>,
    ranges_mm: Vec<f64>,
    diverged: u32,
    trials: u32,
}

impl From<&RobustRange> for RobustLine {
    fn from(robust: &RobustRange) -> Self {
        let RobustRange { ranges_mm, diverged, value_mm, trials } = robust.clone();
        RobustLine { value_mm, ranges_mm, diverged, trials }
    }
}

impl From<&RobustLine> for RobustRange {
    fn from(line: &RobustLine) -> Self {
        RobustRange {
            ranges_mm: line.ranges_mm.clone(),
            diverged: line.diverged,
            value_mm: line.value_mm,
            trials: line.trials,
        }
    }
}

#[derive(Serialize, Deserialize)]
struct WindowLine {
    nominal: Outcome,
    negative_mm: f64,
    positive_mm: f64,
    end_negative: Option<Outcome>,
    end_positive: Option<Outcome>,
}

/// In N/m, as the program computes: N/mm would not read back as the same bits.
#[derive(Serialize, Deserialize)]
struct StiffnessLine {
    #[serde(deserialize_with = "null_is_nan")]
    compliance_n_per_m: f64,
    #[serde(deserialize_with = "null_is_nan")]
    compliance_sd_n_per_m: f64,
    #[serde(deserialize_with = "null_is_nan")]
    assembly_n_per_m: f64,
    #[serde(deserialize_with = "null_is_nan")]
    assembly_sd_n_per_m: f64,
}

/// JSON has no NaN: it is written as null.
fn null_is_nan<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

impl From<&Evaluation> for TaskLine {
    fn from(evaluation: &Evaluation) -> Self {
        let window = &evaluation.window;
        TaskLine {
            measured: MeasuredLine {
                window: WindowLine {
                    nominal: window.nominal,
                    negative_mm: window.negative_mm(),
                    positive_mm: window.positive_mm(),
                    end_negative: window.end_negative,
                    end_positive: window.end_positive,
                },
                failure_counts: evaluation.failure_counts,
                diverged: evaluation.diverged,
                trials: evaluation.trials,
                peak_force_n: evaluation.peak_force_n,
                slip_mm: evaluation.slip_mm,
                simulated_s: evaluation.simulated_s,
                end_shares: evaluation.end_shares,
            },
            drawn: DrawnLine {
                success_rate: evaluation.success.as_ref().map(SuccessLine::from),
                robust_range: evaluation.robust.as_ref().map(RobustLine::from),
            },
        }
    }
}

fn evaluation(found: &MeasuredLine, drawn: &DrawnLine) -> Evaluation {
    let window = &found.window;
    let steps = |mm: f64| (mm / grid_mm(1)).round() as i32;
    Evaluation {
        window: Window {
            nominal: window.nominal,
            negative_steps: steps(window.negative_mm),
            positive_steps: steps(window.positive_mm),
            end_negative: window.end_negative,
            end_positive: window.end_positive,
        },
        failure_counts: found.failure_counts,
        diverged: found.diverged,
        trials: found.trials,
        peak_force_n: found.peak_force_n,
        slip_mm: found.slip_mm,
        simulated_s: found.simulated_s,
        end_shares: found.end_shares,
        success: drawn.success_rate.as_ref().map(SuccessRate::from),
        robust: drawn.robust_range.as_ref().map(RobustRange::from),
    }
}

impl Attributes {
    /// Of an evaluation on one task and the stiffness it was made with.
    pub fn new(evaluation: &Evaluation, stiffness: &Prediction) -> Self {
        let TaskLine { measured, drawn } = TaskLine::from(evaluation);
        Attributes {
            measured,
            stiffness: StiffnessLine {
                compliance_n_per_m: stiffness.compliance.mean,
                compliance_sd_n_per_m: stiffness.compliance.sd,
                assembly_n_per_m: stiffness.assembly.mean,
                assembly_sd_n_per_m: stiffness.assembly.sd,
            },
            hull_distance: stiffness.hull_distance,
            drawn,
            other_tasks: Vec::new(),
        }
    }

    /// The same with the evaluations on other tasks.
    pub fn with_other_tasks(self, other_tasks: &[Evaluation]) -> Self {
        Attributes { other_tasks: other_tasks.iter().map(TaskLine::from).collect(), ..self }
    }

    /// The evaluation on the first task.
    pub fn evaluation(&self) -> Evaluation {
        evaluation(&self.measured, &self.drawn)
    }

    /// The evaluations on the other tasks.
    pub fn other_tasks(&self) -> Vec<Evaluation> {
        self.other_tasks.iter().map(|task| evaluation(&task.measured, &task.drawn)).collect()
    }

    /// The stiffness.
    pub fn prediction(&self) -> Prediction {
        let k = &self.stiffness;
        Prediction {
            compliance: Estimate { mean: k.compliance_n_per_m, sd: k.compliance_sd_n_per_m },
            assembly: Estimate { mean: k.assembly_n_per_m, sd: k.assembly_sd_n_per_m },
            hull_distance: self.hull_distance,
        }
    }
}
