//! Lines of a journal: records of Optuna's JournalStorage with a checksum.
//!
//! A journal begins with a "create study" line and a "study attribute" line; each further line is one
//! evaluation, a complete Optuna trial. Five fields are added to those of Optuna: `evaluation` (the index),
//! `proposal` (in an asynchronous study), `check`, `wall_s` and `cached` (for each task whether its values
//! are from the cache).
//!
//! `check` is the beginning (16 hexadecimal digits) of the SHA-256 of the bytes before `,"check"`. It is
//! followed by `datetime_start`, `datetime_complete`, `wall_s` and `cached`, the only fields that differ
//! between two runs of a study; `sed 's/,"datetime_start".*//'` removes them.

use super::error::LineError;
use super::seal::{CHECK_KEY, seal, unseal};
use super::{Recorded, Timing};
use insertion::{Design, Evaluation, Prediction, Score, Space, Variable};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Optuna's code of a complete trial.
const CREATE_TRIAL: u8 = 4;
/// Optuna's states of a finished trial.
const COMPLETE: u8 = 1;
const FAIL: u8 = 3;
/// Writer of a line, required by Optuna.
pub(super) const WORKER: &str = "finger-opt";

#[derive(Serialize, Deserialize)]
struct TrialLine {
    op_code: u8,
    worker_id: String,
    study_id: u64,
    evaluation: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    proposal: Option<u64>,
    state: u8,
    values: Option<Vec<f64>>,
    params: BTreeMap<String, f64>,
    distributions: BTreeMap<String, String>,
    user_attrs: UserAttributes,
    system_attrs: SystemAttributes,
    /// Always empty.
    intermediate_values: Map<String, Value>,
}

/// Data for which a trial of Optuna has no field.
#[derive(Serialize, Deserialize)]
struct UserAttributes {
    stiffness: Prediction,
    tasks: Vec<Evaluation>,
}

/// Constraints as Optuna's samplers read them; values up to 0 are feasible.
#[derive(Serialize, Deserialize)]
struct SystemAttributes {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    constraints: Vec<f64>,
}

/// Returns the line of an evaluation, with its newline.
///
/// # Errors
/// If it cannot be serialized.
pub fn encode(recorded: &Recorded, space: &Space) -> Result<String, serde_json::Error> {
    let score = recorded.score.as_ref();
    let content = TrialLine {
        op_code: CREATE_TRIAL,
        worker_id: WORKER.to_owned(),
        study_id: 0,
        evaluation: recorded.index,
        proposal: recorded.proposal,
        state: if score.is_some() { COMPLETE } else { FAIL },
        values: score.map(|score| score.values.clone()),
        params: recorded.design.0.clone(),
        distributions: space.parameters.iter().map(distribution).collect(),
        user_attrs: UserAttributes { stiffness: recorded.stiffness, tasks: recorded.tasks.clone() },
        system_attrs: SystemAttributes {
            constraints: score.map_or_else(Vec::new, |score| score.violations.clone()),
        },
        intermediate_values: Map::new(),
    };
    seal(&content, Some(&recorded.timing))
}

/// Returns the evaluation of a line without its newline; `expected` is its index.
///
/// # Errors
/// If the line is damaged or of another evaluation.
pub fn decode(line: &str, expected: u64) -> Result<Recorded, LineError> {
    let (content, rest) = unseal(line)?;
    let format = |error: serde_json::Error| LineError::Format(error.to_string());
    let trial: TrialLine = serde_json::from_str(&content).map_err(format)?;
    if trial.op_code != CREATE_TRIAL {
        return Err(LineError::Format(format!("op_code {} is not 4", trial.op_code)));
    }
    if trial.evaluation != expected {
        return Err(LineError::Order(trial.evaluation, expected));
    }
    let timing: Timing = serde_json::from_str(&rest).map_err(format)?;
    Ok(Recorded {
        index: trial.evaluation,
        proposal: trial.proposal,
        score: trial
            .values
            .map(|values| Score { values, violations: trial.system_attrs.constraints }),
        design: Design(trial.params),
        stiffness: trial.user_attrs.stiffness,
        tasks: trial.user_attrs.tasks,
        timing,
    })
}

/// Returns whether a line is a record of an Optuna journal by another program.
pub fn is_foreign(line: &str) -> bool {
    #[derive(Deserialize)]
    struct Record {
        #[serde(rename = "op_code")]
        _op_code: u8,
        worker_id: String,
    }
    let record = || serde_json::from_str::<Record>(line).ok();
    !line.contains(CHECK_KEY) && record().is_some_and(|record| record.worker_id != WORKER)
}

/// Returns a parameter as Optuna describes it: JSON text inside the JSON line.
fn distribution(Variable { key, low, high, step, .. }: &Variable) -> (String, String) {
    let attributes = json!({"low": low, "high": high, "log": false, "step": step});
    (key.to_string(), json!({"name": "FloatDistribution", "attributes": attributes}).to_string())
}
