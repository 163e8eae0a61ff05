//! What a study's values were measured with.

use super::differences::differences;
use crate::trial::engine::{EngineKind, EngineRecord};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The sources that this program was built from.
pub const SOURCES: &str = env!("FINGER_OPT_SOURCE_SHA256");

/// What computed the values, and from which inputs: values of different provenance do not
/// belong into one study unless the user says so.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Version of this program.
    pub program: String,
    /// SHA-256 of the program's sources, in hexadecimal.
    pub source_sha256: String,
    /// SHA-256 of each input file by its role (`task_1` and so on, `space`, `robot`,
    /// `stiffness`; `uncertainty`, the `finger` of computed ones, `measurements` and `priors` where
    /// there is one), in hexadecimal.
    pub input_sha256: BTreeMap<String, String>,
    /// The contact engine.
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
    /// What they were measured with.
    pub provenance: Provenance,
}

impl Provenance {
    /// Of what this program measures now from these inputs.
    pub fn new(engine: EngineKind, input_sha256: BTreeMap<String, String>) -> Self {
        Provenance {
            program: env!("CARGO_PKG_VERSION").to_owned(),
            source_sha256: SOURCES.to_owned(),
            input_sha256,
            engine: engine.record(),
        }
    }

    /// Whether another simulates the same: measurements on a bench change no simulated value.
    pub fn simulates_like(&self, other: &Provenance) -> bool {
        let simulated = |provenance: &Provenance| {
            let mut provenance = provenance.clone();
            provenance.input_sha256.retain(|role, _| !BENCH_ROLES.contains(&&**role));
            provenance
        };
        simulated(self) == simulated(other)
    }

    /// Whether the roles, which become names of files, can be ours.
    ///
    /// # Errors
    /// Which one cannot.
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
