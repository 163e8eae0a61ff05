//! Provenance of a study's values.

use super::differences::differences;
use insertion::EngineKind;
use insertion::trial::engine::EngineRecord;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// SHA-256 of the sources that determine the results of a study.
pub const SOURCES: &str = env!("FINGER_OPT_STUDY_SHA256");
/// SHA-256 of the sources that determine the evaluation of a design.
pub const SIMULATION_SOURCES: &str = env!("FINGER_OPT_SIMULATION_SHA256");

/// Program and inputs that determine the values of a study. Values of different provenance are not
/// mixed in one study unless the user accepts that.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Version of this program.
    pub program: String,
    /// SHA-256 of the sources that determine the results of a study, in hexadecimal.
    pub source_sha256: String,
    /// SHA-256 of the sources that determine the evaluation of a design.
    pub simulation_sha256: String,
    /// SHA-256 of each input file by its role, in hexadecimal: `task_1` and so on, `space`, `robot`,
    /// `stiffness`; if given `cell`, `uncertainty`, `finger` (of computed fingers), `measurements`, `priors`.
    pub input_sha256: BTreeMap<String, String>,
    /// Contact engine with its settings.
    pub engine: EngineRecord,
}

/// Roles of the inputs that no simulation reads: bench measurements, and priors of the parameters that
/// were not measured.
pub const BENCH_ROLES: [&str; 2] = ["measurements", "priors"];

/// Consecutive evaluations of the same provenance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// Index of its first evaluation.
    pub first: u64,
    /// Provenance of these evaluations.
    pub provenance: Provenance,
}

impl Provenance {
    /// Returns the provenance of this program and these inputs.
    pub fn new(engine: EngineKind, input_sha256: BTreeMap<String, String>) -> Self {
        let (program, source_sha256) = (env!("CARGO_PKG_VERSION").to_owned(), SOURCES.to_owned());
        let (simulation_sha256, engine) = (SIMULATION_SOURCES.to_owned(), engine.record());
        Provenance { program, source_sha256, simulation_sha256, input_sha256, engine }
    }

    /// Returns whether this program gives the same simulation results.
    pub fn is_of_this_program(&self) -> bool {
        self.simulation_sha256 == SIMULATION_SOURCES
    }

    /// Returns whether both give the same simulation results; measurements and priors may differ.
    pub fn simulates_like(&self, other: &Provenance) -> bool {
        let simulated = |provenance: &Provenance| {
            let mut provenance = provenance.clone();
            provenance.source_sha256.clear();
            provenance.input_sha256.retain(|role, _| !BENCH_ROLES.contains(&&**role));
            provenance
        };
        simulated(self) == simulated(other)
    }

    /// Returns the fields that differ, one line each; `None` if there are none.
    pub fn differences(&self, now: &Provenance) -> Option<String> {
        differences(self, now, ["the study", "now"])
    }
}
