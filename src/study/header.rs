//! The first two lines of a journal: whose it is.

use super::config::{StudyConfig, Versions, differences};
use super::line::WORKER;
use super::seal::{seal, unseal};
use crate::evaluation::objective::{Aggregate, Constraint, Measure, Objectives};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the journal's format; every later program reads all earlier ones.
pub const SCHEMA_VERSION: u64 = 1;

const CREATE_STUDY: u8 = 0;
const STUDY_USER_ATTRIBUTE: u8 = 2;
const MINIMISE: u8 = 1;
const MAXIMISE: u8 = 2;

#[derive(Serialize)]
struct CreateStudy<'a> {
    op_code: u8,
    worker_id: &'a str,
    study_name: &'a str,
    directions: Vec<u8>,
}

#[derive(Serialize, Deserialize)]
struct StudyAttributes {
    op_code: u8,
    worker_id: String,
    study_id: u64,
    user_attr: UserAttribute,
}

/// Optuna takes one attribute a line, so all of ours is one.
#[derive(Serialize, Deserialize)]
struct UserAttribute {
    finger_opt: Identity,
}

/// The configuration without what may change while the journal stays the same.
#[derive(Serialize, Deserialize)]
struct Identity {
    schema_version: u64,
    task: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    other_tasks: Vec<String>,
    space: String,
    robot: String,
    engine: String,
    optimizer: String,
    objective: Objectives,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    constraints: Vec<Constraint>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    aggregate: Option<Aggregate>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    uncertainty: Option<String>,
    seed: u64,
    batch: u64,
    /// With a polish the budget decides where it begins.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    polish: Option<Polish>,
    versions: Versions,
    input_sha256: BTreeMap<String, String>,
}

#[derive(Serialize, Deserialize)]
struct Polish {
    after: u64,
    at_most: u64,
}

impl From<&StudyConfig> for Identity {
    fn from(config: &StudyConfig) -> Self {
        Identity {
            schema_version: SCHEMA_VERSION,
            task: config.task.clone(),
            other_tasks: config.other_tasks.clone(),
            space: config.space.name().to_owned(),
            robot: config.robot.clone(),
            engine: config.engine.clone(),
            optimizer: config.optimizer.clone(),
            objective: config.objective.clone(),
            constraints: config.constraints.clone(),
            aggregate: config.aggregate.clone(),
            uncertainty: config.uncertainty.clone(),
            seed: config.seed,
            batch: config.batch,
            polish: (config.polish > 0)
                .then_some(Polish { after: config.budget, at_most: config.polish }),
            versions: config.versions.clone(),
            input_sha256: config.input_sha256.clone(),
        }
    }
}

/// The two lines a journal of this configuration begins with.
pub fn encode(config: &StudyConfig) -> Result<String, serde_json::Error> {
    let direction = |measure: &Measure| if measure.sense() > 0.0 { MAXIMISE } else { MINIMISE };
    let create = CreateStudy {
        op_code: CREATE_STUDY,
        worker_id: WORKER,
        study_name: &config.name(),
        directions: config.objective.measures().iter().map(direction).collect(),
    };
    let attributes = StudyAttributes {
        op_code: STUDY_USER_ATTRIBUTE,
        worker_id: WORKER.to_owned(),
        study_id: 0,
        user_attr: UserAttribute { finger_opt: Identity::from(config) },
    };
    Ok(seal(&create, NO_TIMES)? + &seal(&attributes, NO_TIMES)?)
}

const NO_TIMES: Option<&()> = None;

/// Whether two lines begin a journal of this configuration, and if not, why.
pub fn check(first: &str, second: &str, config: &StudyConfig) -> Result<(), String> {
    for (number, line) in [(1, first), (2, second)] {
        if unseal(line).is_err() {
            return Err(format!("line {number} is damaged, or was not written by this program"));
        }
    }
    let (attributes, _) = unseal(second).map_err(|error| error.to_string())?;
    let version = serde_json::from_str::<serde_json::Value>(&attributes)
        .ok()
        .and_then(|value| value["user_attr"]["finger_opt"]["schema_version"].as_u64());
    match version {
        Some(1..=SCHEMA_VERSION) => {}
        Some(newer) => {
            return Err(format!(
                "its schema version is {newer}; this program reads versions 1 to {SCHEMA_VERSION}"
            ));
        }
        None => return Err("line 2 has no schema_version".to_owned()),
    }
    let found: StudyAttributes =
        serde_json::from_str(&attributes).map_err(|error| format!("line 2: {error}"))?;
    match differences(
        &found.user_attr.finger_opt,
        &Identity::from(config),
        ["the journal", "study.toml"],
    ) {
        Some(differences) => Err(format!("it was made with another configuration:\n{differences}")),
        None => Ok(()),
    }
}
