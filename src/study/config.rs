//! The resolved configuration of a study, as `study.toml` keeps it.

use crate::space::Space;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Everything that decides what a study measures. The number of threads is not
/// part of it: it changes no result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyConfig {
    /// Name of the task.
    pub task: String,
    /// Name of the robot.
    pub robot: String,
    /// Name of the contact engine.
    pub engine: String,
    /// Name of the optimizer.
    pub optimizer: String,
    /// Name of the objective.
    pub objective: String,
    /// Seed of every random stream of the study.
    pub seed: u64,
    /// Evaluations in all; the one field that may be raised later.
    pub budget: u64,
    /// Designs the optimizer proposes at a time.
    pub batch: u64,
    /// Versions of what computed the results.
    pub versions: Versions,
    /// SHA-256 of each input file by its role (`task`, `space`, `robot`, `stiffness`), in hexadecimal.
    pub input_sha256: BTreeMap<String, String>,
    /// The search space in full.
    pub space: Space,
}

/// Versions of what computed the results.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Versions {
    /// This program.
    pub program: String,
    /// The contact engine.
    pub engine: String,
}
