//! Unit of work of a study whose designs are evaluated by workers, for example on other computers. The
//! evaluation is deterministic and may be repeated.
//!
//! A [`Work`] holds everything that determines an evaluation: design, texts of the input files, seed,
//! engine with its settings, and the SHA-256 of the program's sources; a worker built from other sources
//! rejects it. The result contains the SHA-256 of its work. Both are a line of JSON with a checksum, as in
//! journals.

use super::seal::{seal, unseal};
use super::{Inputs, Proposal, ProposalResult, Provenance, Timing, sha256_hex};
use insertion::{Evaluation, Evaluations, Prediction};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Proposal with everything that determines its evaluation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Work {
    /// The design, its number and its race.
    pub proposal: Proposal,
    /// Seed of the drawn errors.
    pub seed: u64,
    /// Whether the success rate under drawn errors is determined.
    pub success_rate: bool,
    /// Whether the robust range under drawn errors is determined.
    pub robust_range: bool,
    /// Provenance that the worker must have.
    pub provenance: Provenance,
    /// Texts of the input files by role.
    pub inputs: Inputs,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WorkResult {
    work_sha256: String,
    tasks: Vec<Evaluation>,
}

/// Reason why work or its result is rejected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct WorkError(String);

/// Parses contents and times of a line with a checksum; `kind` names the line in errors.
fn read<T: DeserializeOwned, U: DeserializeOwned>(
    bytes: &[u8],
    kind: &str,
) -> Result<(T, U), WorkError> {
    let parse = || -> Result<(T, U), Box<dyn std::error::Error>> {
        let (contents, times) = unseal(std::str::from_utf8(bytes)?.trim_end())?;
        Ok((serde_json::from_str(&contents)?, serde_json::from_str(&times)?))
    };
    parse().map_err(|problem| WorkError(format!("not a {kind} of this program: {problem}")))
}

/// Serializes contents and times as a line with a checksum.
fn encoded(contents: &impl Serialize, timing: Option<&Timing>) -> Result<Vec<u8>, WorkError> {
    Ok(seal(contents, timing).map_err(|error| WorkError(error.to_string()))?.into_bytes())
}

impl Work {
    /// Serializes the work.
    ///
    /// # Errors
    /// If it cannot be serialized.
    pub fn encode(&self) -> Result<Vec<u8>, WorkError> {
        encoded(self, None)
    }

    /// Parses work from bytes.
    ///
    /// # Errors
    /// If the bytes are damaged or come from another program.
    pub fn decode(bytes: &[u8]) -> Result<Work, WorkError> {
        Ok(read::<_, serde::de::IgnoredAny>(bytes, "work")?.0)
    }

    /// Checks that a worker with the provenance `own` simulates like the study; `worker` is its host and
    /// process.
    ///
    /// # Errors
    /// If the worker simulates differently, with the differences.
    pub fn check_worker(&self, own: &Provenance, worker: &str) -> Result<(), WorkError> {
        match self.provenance.differences(own) {
            Some(differences) if !self.provenance.simulates_like(own) => Err(WorkError(format!(
                "the worker {worker} would simulate differently from the study:\n\
                     {differences}\ninstall the same version of finger-opt there"
            ))),
            _ => Ok(()),
        }
    }

    /// Serializes the result of this work.
    ///
    /// # Errors
    /// If it cannot be serialized.
    pub fn encode_result(&self, result: ProposalResult) -> Result<Vec<u8>, WorkError> {
        let tasks = result.evaluations.tasks;
        let done = WorkResult { work_sha256: sha256_hex(&self.encode()?), tasks };
        encoded(&done, Some(&result.timing))
    }

    /// Parses bytes and checks that they are the result of this work; `stiffness` is the prediction of the
    /// study's own model.
    ///
    /// # Errors
    /// If the bytes are damaged or are the result of other work.
    pub fn check(&self, bytes: &[u8], stiffness: Prediction) -> Result<ProposalResult, WorkError> {
        let (WorkResult { work_sha256, tasks }, timing) = read(bytes, "result")?;
        if work_sha256 != sha256_hex(&self.encode()?) {
            return Err(WorkError("the result belongs to other work".to_owned()));
        }
        let evaluations = Evaluations { stiffness, tasks, cached: Vec::new() };
        Ok(ProposalResult { number: self.proposal.number, evaluations, timing })
    }
}
