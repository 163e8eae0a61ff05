//! Header of a journal: its first two lines, which identify the study.

use super::differences::differences;
use super::error::LineError;
use super::line::WORKER;
use super::seal::{seal, unseal};
use super::{Segment, StudyConfig};
use insertion::Measure;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Version of the journal's format.
pub const SCHEMA_VERSION: u64 = 2;

/// Optuna's operation codes and codes of directions.
const CREATE_STUDY: u8 = 0;
const STUDY_USER_ATTRIBUTE: u8 = 2;
const MINIMISE: u8 = 1;
const MAXIMISE: u8 = 2;
/// Name of the only attribute of a study.
const ATTRIBUTE: &str = "finger_opt";

/// Study attribute of Optuna, one per line.
#[derive(Serialize, Deserialize)]
struct AttributeLine<T> {
    op_code: u8,
    worker_id: String,
    study_id: u64,
    user_attr: BTreeMap<String, T>,
}

fn attribute(name: String, value: impl Serialize) -> Result<String, serde_json::Error> {
    let (op_code, user_attr) = (STUDY_USER_ATTRIBUTE, BTreeMap::from([(name, value)]));
    let line = AttributeLine { op_code, worker_id: WORKER.to_owned(), study_id: 0, user_attr };
    seal(&line, None)
}

/// Returns the configuration without the fields that may change while the journal stays valid: early stopping, the
/// analyses after the search, and the budget of a study without a polish.
fn identity(config: &StudyConfig) -> Result<Value, serde_json::Error> {
    let mut fields = serde_json::to_value(config)?;
    let mut identity = json!({"schema_version": SCHEMA_VERSION});
    if let (Value::Object(fields), Value::Object(identity)) = (&mut fields, &mut identity) {
        // Each of these two calls determines the order of the other fields, and with it the header of existing
        // journals: `shift_remove` keeps the order, `remove` does not.
        fields.shift_remove("settles");
        fields.remove("conclusion");
        if config.polish == 0 {
            fields.remove("budget");
        }
        identity.append(fields);
    }
    Ok(identity)
}

/// Returns the header of a journal of this configuration.
///
/// # Errors
/// If it cannot be serialized.
pub fn encode(config: &StudyConfig) -> Result<String, serde_json::Error> {
    let direction = |measure: &Measure| if measure.sense() > 0.0 { MAXIMISE } else { MINIMISE };
    let create = json!({
        "op_code": CREATE_STUDY,
        "worker_id": WORKER,
        "study_name": config.name(),
        "directions": config.objective.measures().iter().map(direction).collect::<Vec<_>>(),
    });
    Ok(seal(&create, None)? + &attribute(ATTRIBUTE.to_owned(), identity(config)?)?)
}

/// Returns the line that begins the segment with this number, counted from 1.
///
/// # Errors
/// If it cannot be serialized.
pub fn encode_segment(number: usize, segment: &Segment) -> Result<String, serde_json::Error> {
    attribute(format!("{ATTRIBUTE}_segment_{number}"), segment)
}

/// Returns the segment that a line begins; `None` for other lines.
///
/// # Errors
/// If the line is damaged.
pub fn decode_segment(line: &str) -> Result<Option<Segment>, LineError> {
    if !line.starts_with(&format!("{{\"op_code\":{STUDY_USER_ATTRIBUTE},")) {
        return Ok(None);
    }
    let (content, _) = unseal(line)?;
    let line: AttributeLine<Segment> =
        serde_json::from_str(&content).map_err(|error| LineError::Format(error.to_string()))?;
    let segment = line.user_attr.into_values().next();
    let missing = || LineError::Format("a segment without its provenance".to_owned());
    segment.ok_or_else(missing).map(Some)
}

/// Checks the header of a journal of this configuration.
///
/// # Errors
/// The problem, without the file: damage, another schema version, or the fields that differ.
pub fn check(first: &str, second: &str, config: &StudyConfig) -> Result<(), String> {
    let damaged = |n: u8| format!("line {n} is damaged, or was not written by this program");
    unseal(first).map_err(|_| damaged(1))?;
    let (attributes, _) = unseal(second).map_err(|_| damaged(2))?;
    let mut line: AttributeLine<Value> =
        serde_json::from_str(&attributes).map_err(|error| format!("line 2: {error}"))?;
    let found = line.user_attr.remove(ATTRIBUTE).unwrap_or_default();
    match found["schema_version"].as_u64() {
        Some(SCHEMA_VERSION) => {}
        Some(other) => {
            return Err(format!(
                "its schema version is {other}; this program reads version {SCHEMA_VERSION}"
            ));
        }
        None => return Err("line 2 has no schema_version".to_owned()),
    }
    let expected = identity(config).map_err(|error| error.to_string())?;
    match differences(&found, &expected, ["the journal", "study.toml"]) {
        Some(differences) => Err(format!("it was made with another configuration:\n{differences}")),
        None => Ok(()),
    }
}
