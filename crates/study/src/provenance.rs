//! Provenance of a study's values.

use super::differences::differences;
use insertion::trial::engine::{EngineKind, EngineRecord};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The sources of this program that decide what a study finds.
pub const SOURCES: &str = env!("FINGER_OPT_STUDY_SHA256");
/// Those of them that decide the evaluation of a design.
pub const SIMULATION_SOURCES: &str = env!("FINGER_OPT_SIMULATION_SHA256");

/// Program that computed the values, and its inputs: values of different provenance do not
/// belong into one study unless the user says so.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Version of this program.
    pub program: String,
    /// SHA-256 of the sources that decide what a study finds, in hexadecimal; up to version 0.3.0 of
    /// all sources.
    pub source_sha256: String,
    /// SHA-256 of those of them that decide the evaluation of a design; `None` up to version 0.3.0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulation_sha256: Option<String>,
    /// SHA-256 of each input file by its role (`task_1` and so on, `space`, `robot`,
    /// `stiffness`; `cell`, `uncertainty`, the `finger` of computed ones, `measurements` and `priors` where
    /// there is one), in hexadecimal.
    pub input_sha256: BTreeMap<String, String>,
    pub engine: EngineRecord,
}

/// Roles of the inputs that no simulation reads: what was measured on a bench, and the bounds of what
/// nobody measured.
pub const BENCH_ROLES: [&str; 2] = ["measurements", "priors"];

/// Evaluations of one provenance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// Index of its first evaluation.
    pub first: u64,
    /// Provenance of these evaluations.
    pub provenance: Provenance,
}

impl Provenance {
    /// Of what this program measures now from these inputs.
    pub fn new(engine: EngineKind, input_sha256: BTreeMap<String, String>) -> Self {
        Provenance {
            program: env!("CARGO_PKG_VERSION").to_owned(),
            source_sha256: SOURCES.to_owned(),
            simulation_sha256: Some(SIMULATION_SOURCES.to_owned()),
            input_sha256,
            engine: engine.record(),
        }
    }

    /// Whether another simulates the same: measurements on a bench change no simulated value.
    pub fn simulates_like(&self, other: &Provenance) -> bool {
        let simulated = |provenance: &Provenance| {
            let mut provenance = provenance.clone();
            if provenance.simulation_sha256.is_some() {
                provenance.source_sha256.clear();
            }
            provenance.input_sha256.retain(|role, _| !BENCH_ROLES.contains(&&**role));
            provenance
        };
        simulated(self) == simulated(other)
    }

    /// Whether the roles, which become names of files, can be ours; if not, which one cannot.
    pub fn check(&self) -> Result<(), String> {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        match self.input_sha256.keys().find(|role| !role.chars().all(plain)) {
            None => Ok(()),
            Some(role) => Err(format!("input_sha256: `{role}` is no input file")),
        }
    }

    /// In what another differs, one line each; `None` if in nothing.
    pub fn differences(&self, now: &Provenance) -> Option<String> {
        differences(self, now, ["the study", "now"])
    }
}
