//! Unit of work of a study that is measured elsewhere: a pure function from bytes to bytes that may be
//! repeated.
//!
//! A [`Work`] holds everything that determines a measurement: design, texts of the input files, seed,
//! engine with its settings, and the SHA-256 of the program's sources; a worker of other sources refuses
//! it. The result names the work by its SHA-256. Both are a line of JSON with a checksum, as in journals.

use super::folder::Inputs;
use super::provenance::Provenance;
use super::record::Timing;
use super::scheduler::{Proposal, ProposalResult};
use super::seal::{seal, sha256_hex, unseal};
use insertion::evaluation::Evaluation;
use insertion::evaluation::evaluator::Measured;
use insertion::surrogate::Prediction;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fmt::Display;

/// Proposal with everything that determines its measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Work {
    /// The design, its number and its race.
    pub proposal: Proposal,
    /// Seed of the drawn errors.
    pub seed: u64,
    /// Whether the success rate under drawn errors is measured.
    pub success_rate: bool,
    /// Whether the robust range under drawn errors is measured.
    pub robust_range: bool,
    /// Provenance that the worker must have.
    pub provenance: Provenance,
    /// Texts of the input files by role.
    pub inputs: Inputs,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Done {
    work_sha256: String,
    tasks: Vec<Evaluation>,
}

/// Reason for which work or its result is rejected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct WorkError(String);

impl WorkError {
    fn bytes(kind: &str, problem: impl Display) -> Self {
        WorkError(format!("not a {kind} of this program: {problem}"))
    }
}

/// Returns content and times of a line with a checksum.
fn read<T: DeserializeOwned, U: DeserializeOwned>(
    bytes: &[u8],
    kind: &str,
) -> Result<(T, U), WorkError> {
    let json = |error: serde_json::Error| WorkError::bytes(kind, error);
    let text = std::str::from_utf8(bytes).map_err(|error| WorkError::bytes(kind, error))?;
    let (contents, times) =
        unseal(text.trim_end()).map_err(|error| WorkError::bytes(kind, error))?;
    Ok((
        serde_json::from_str(&contents).map_err(json)?,
        serde_json::from_str(&times).map_err(json)?,
    ))
}

fn encoded(contents: &impl Serialize, timing: Option<&Timing>) -> Result<Vec<u8>, WorkError> {
    let line = seal(contents, timing);
    Ok(line.map_err(|error| WorkError(error.to_string()))?.into_bytes())
}

impl Work {
    /// Returns the work as bytes.
    ///
    /// # Errors
    /// If it cannot be serialized.
    pub fn encode(&self) -> Result<Vec<u8>, WorkError> {
        encoded(self, None)
    }

    /// Returns the work of these bytes.
    ///
    /// # Errors
    /// If they are damaged or of another program.
    pub fn decode(bytes: &[u8]) -> Result<Work, WorkError> {
        Ok(read::<_, serde::de::IgnoredAny>(bytes, "work")?.0)
    }

    /// Checks that a worker of this provenance simulates as the study does; `worker` is its host and
    /// process.
    ///
    /// # Errors
    /// If it does not, with the differences.
    pub fn admit(&self, own: &Provenance, worker: &str) -> Result<(), WorkError> {
        match self.provenance.differences(own) {
            Some(differences) if !self.provenance.simulates_like(own) => Err(WorkError(format!(
                "the worker {worker} would measure with something else than the study:\n\
                     {differences}\ninstall the same version of finger-opt there"
            ))),
            _ => Ok(()),
        }
    }

    /// Returns the result as bytes.
    ///
    /// # Errors
    /// If it cannot be serialized.
    pub fn result(&self, result: ProposalResult) -> Result<Vec<u8>, WorkError> {
        let tasks = result.measured.tasks;
        let done = Done { work_sha256: sha256_hex(&self.encode()?), tasks };
        encoded(&done, Some(&result.timing))
    }

    /// Returns the result of this work; `stiffness` is the prediction of the study's own model.
    ///
    /// # Errors
    /// If the bytes are damaged or the result of other work.
    pub fn check(&self, bytes: &[u8], stiffness: Prediction) -> Result<ProposalResult, WorkError> {
        let (Done { work_sha256, tasks }, timing) = read(bytes, "result")?;
        if work_sha256 != sha256_hex(&self.encode()?) {
            return Err(WorkError("the result is of another work".to_owned()));
        }
        let measured = Measured { stiffness, tasks, cached: Vec::new() };
        Ok(ProposalResult { number: self.proposal.number, measured, timing })
    }
}
