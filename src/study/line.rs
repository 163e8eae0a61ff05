//! The lines of a journal: Optuna's JournalStorage records, with a check.
//!
//! A journal begins with a "create study" line and a "study attribute" line;
//! every further line is one finished evaluation, a whole Optuna trial. Three
//! fields are ours beside Optuna's: `evaluation` (the index), `check`, and `wall_s`.
//!
//! `check` is the beginning (16 hexadecimal digits) of the SHA-256 of the
//! line's bytes before `,"check"`. After it stand `datetime_start`,
//! `datetime_complete` and `wall_s`, the only fields that differ between two
//! runs of the same study; [`strip_times`] (or `sed 's/,"datetime_start".*//'`) removes them.

use super::record::{Recorded, Timing};
use super::time::is_timestamp;
use crate::evaluation::{Evaluation, Outcome, Window, grid_mm};
use crate::space::{Design, Parameter, Space};
use crate::surrogate::{Estimate, Prediction};
use serde::{Deserialize, Deserializer, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Optuna's code of a whole trial.
const CREATE_TRIAL: u8 = 4;
/// Optuna's states of a finished trial.
const COMPLETE: u8 = 1;
const FAIL: u8 = 3;
/// Optuna wants to know who wrote a line.
pub(super) const WORKER: &str = "finger-opt";
const CHECK_KEY: &str = ",\"check\":\"";
const TIME_KEY: &str = ",\"datetime_start\":";

/// What is wrong with one line; the journal adds the file and the line number.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum LineError {
    /// No check, or one that does not fit.
    #[error("damaged: its contents do not fit its `check`")]
    Check,
    /// The check fits, the contents do not.
    #[error("not a line of this program's journals: {0}")]
    Format(String),
    /// Lines are missing, doubled or in the wrong order.
    #[error("evaluation {found} stands where evaluation {expected} belongs")]
    Order {
        /// What the line says.
        found: u64,
        /// What its place in the file says.
        expected: u64,
    },
}

#[derive(Serialize, Deserialize)]
struct TrialLine {
    op_code: u8,
    worker_id: String,
    study_id: u64,
    evaluation: u64,
    state: u8,
    values: Option<Vec<f64>>,
    params: BTreeMap<String, f64>,
    distributions: BTreeMap<String, String>,
    user_attrs: Attributes,
    system_attrs: Empty,
    intermediate_values: Empty,
}

#[derive(Serialize, Deserialize)]
struct Empty {}

#[derive(Serialize)]
struct Distribution {
    name: &'static str,
    attributes: Bounds,
}

#[derive(Serialize)]
struct Bounds {
    low: f64,
    high: f64,
    log: bool,
    step: f64,
}

/// What Optuna has no field for.
#[derive(Serialize, Deserialize)]
struct Attributes {
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
    stiffness: StiffnessLine,
    #[serde(deserialize_with = "null_is_nan")]
    hull_distance: f64,
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

#[derive(Serialize, Deserialize)]
struct Times {
    datetime_start: String,
    datetime_complete: String,
    wall_s: f64,
}

/// JSON has no NaN: it is written as null.
fn null_is_nan<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

/// The line of one evaluation, with its newline.
pub fn encode(recorded: &Recorded, space: &Space) -> Result<String, serde_json::Error> {
    let value = recorded.value.filter(|value| value.is_finite());
    let content = TrialLine {
        op_code: CREATE_TRIAL,
        worker_id: WORKER.to_owned(),
        study_id: 0,
        evaluation: recorded.index,
        state: if value.is_some() { COMPLETE } else { FAIL },
        values: value.map(|value| vec![value]),
        params: recorded.design.0.clone(),
        distributions: space.parameters().iter().map(distribution).collect::<Result<_, _>>()?,
        user_attrs: Attributes::new(&recorded.evaluation, &recorded.stiffness),
        system_attrs: Empty {},
        intermediate_values: Empty {},
    };
    let times = Times {
        datetime_start: recorded.timing.datetime_start.clone(),
        datetime_complete: recorded.timing.datetime_complete.clone(),
        wall_s: recorded.timing.wall_s,
    };
    seal(&content, Some(&times))
}

/// The evaluation of a line without its newline; `expected` is the index its place gives it.
pub fn decode(line: &str, expected: u64) -> Result<Recorded, LineError> {
    let (content, rest) = unseal(line)?;
    let format = |error: serde_json::Error| LineError::Format(error.to_string());
    let trial: TrialLine = serde_json::from_str(&content).map_err(format)?;
    if trial.op_code != CREATE_TRIAL {
        return Err(LineError::Format(format!("op_code {} is not 4", trial.op_code)));
    }
    if trial.evaluation != expected {
        return Err(LineError::Order { found: trial.evaluation, expected });
    }
    let times: Times = serde_json::from_str(&rest).map_err(format)?;
    for stamp in [&times.datetime_start, &times.datetime_complete] {
        if !is_timestamp(stamp) {
            return Err(LineError::Format(format!("`{stamp}` is not a time stamp")));
        }
    }
    Ok(Recorded {
        index: trial.evaluation,
        value: trial.values.and_then(|values| values.first().copied()),
        design: Design(trial.params),
        stiffness: trial.user_attrs.prediction(),
        evaluation: trial.user_attrs.evaluation(),
        timing: Timing {
            datetime_start: times.datetime_start,
            datetime_complete: times.datetime_complete,
            wall_s: times.wall_s,
        },
    })
}

/// A journal without the fields that differ between two runs of the same study.
pub fn strip_times(journal: &str) -> String {
    let content = |line: &str| line.split(TIME_KEY).next().unwrap_or(line).to_owned() + "\n";
    journal.lines().map(content).collect()
}

/// `contents` as one JSON line, closed by its check and, after that, `times`.
pub(super) fn seal(
    contents: &impl Serialize,
    times: Option<&impl Serialize>,
) -> Result<String, serde_json::Error> {
    let mut line = serde_json::to_string(contents)?;
    line.pop();
    let check = check(&line);
    line.push_str(CHECK_KEY);
    line.push_str(&check);
    line.push('"');
    match times {
        Some(times) => {
            line.push(',');
            line.push_str(&serde_json::to_string(times)?[1..]);
        }
        None => line.push('}'),
    }
    line.push('\n');
    Ok(line)
}

/// The JSON objects before and after the check of a line, which must fit.
pub(super) fn unseal(line: &str) -> Result<(String, String), LineError> {
    let (content, rest) = line.rsplit_once(CHECK_KEY).ok_or(LineError::Check)?;
    let (found, rest) = rest.split_once('"').ok_or(LineError::Check)?;
    if found != check(content) {
        return Err(LineError::Check);
    }
    let rest = match rest.strip_prefix(',') {
        Some(times) => format!("{{{times}"),
        None if rest == "}" => "{}".to_owned(),
        None => return Err(LineError::Check),
    };
    Ok((format!("{content}}}"), rest))
}

fn check(content: &str) -> String {
    let digest = Sha256::digest(content.as_bytes());
    digest.iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

/// A parameter as Optuna describes it: a JSON text within the JSON line.
fn distribution(parameter: &Parameter) -> Result<(String, String), serde_json::Error> {
    let Parameter { key, low, high, step, .. } = parameter;
    let attributes = Bounds { low: *low, high: *high, log: false, step: *step };
    let text = serde_json::to_string(&Distribution { name: "FloatDistribution", attributes })?;
    Ok((key.clone(), text))
}

impl Attributes {
    fn new(evaluation: &Evaluation, stiffness: &Prediction) -> Self {
        let window = &evaluation.window;
        Attributes {
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
            stiffness: StiffnessLine {
                compliance_n_per_m: stiffness.compliance.mean,
                compliance_sd_n_per_m: stiffness.compliance.sd,
                assembly_n_per_m: stiffness.assembly.mean,
                assembly_sd_n_per_m: stiffness.assembly.sd,
            },
            hull_distance: stiffness.hull_distance,
        }
    }

    fn evaluation(&self) -> Evaluation {
        let window = &self.window;
        let steps = |mm: f64| (mm / grid_mm(1)).round() as i32;
        Evaluation {
            window: Window {
                nominal: window.nominal,
                negative_steps: steps(window.negative_mm),
                positive_steps: steps(window.positive_mm),
                end_negative: window.end_negative,
                end_positive: window.end_positive,
            },
            failure_counts: self.failure_counts,
            diverged: self.diverged,
            trials: self.trials,
            peak_force_n: self.peak_force_n,
            slip_mm: self.slip_mm,
            simulated_s: self.simulated_s,
        }
    }

    fn prediction(&self) -> Prediction {
        let k = &self.stiffness;
        Prediction {
            compliance: Estimate { mean: k.compliance_n_per_m, sd: k.compliance_sd_n_per_m },
            assembly: Estimate { mean: k.assembly_n_per_m, sd: k.assembly_sd_n_per_m },
            hull_distance: self.hull_distance,
        }
    }
}
