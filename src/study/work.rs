//! The unit of work of a study that is measured elsewhere: a pure function from bytes to
//! bytes, safe to run twice.
//!
//! A [`Work`] says all that decides a measurement: the design, the texts of the input files,
//! seed, engine with its settings, and the SHA-256 of the program's sources. A worker of other
//! sources refuses it. The [`Done`] that comes back names the work by its SHA-256 and holds
//! evaluations in their one form. Both are a line of JSON closed by its check, as in journals.
//! Nothing of a result is believed before [`Work::check`] has looked at it.

use super::course::{Arrived, Wanted};
use super::folder::Inputs;
use super::provenance::Provenance;
use super::record::Timing;
use super::seal::{seal, sha256_hex, unseal};
use super::time::is_timestamp;
use insertion::evaluation::Evaluation;
use insertion::evaluation::evaluator::Measured;
use insertion::outcome::Outcome;
use insertion::space::Design;
use insertion::surrogate::Prediction;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// A design, and all that decides what is measured of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Work {
    /// The number of its proposal in the study.
    pub proposal: u64,
    /// The design, in the units its keys carry.
    pub design: Design,
    /// Seed of the drawn errors.
    pub seed: u64,
    /// Whether the success rate under drawn errors is measured.
    pub success_rate: bool,
    /// Whether the robust range under drawn errors is measured.
    pub robust_range: bool,
    /// How many tasks there are.
    pub tasks: u64,
    /// What it is to be measured with.
    pub provenance: Provenance,
    /// Texts of the input files by role.
    pub inputs: Inputs,
}

/// What was measured of one work.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Done {
    work_sha256: String,
    source_sha256: String,
    worker: String,
    design: Design,
    stiffness: Prediction,
    tasks: Vec<Evaluation>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Times {
    datetime_start: String,
    datetime_complete: String,
    wall_s: f64,
}

/// Why a work was not done, or its result is not believed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WorkError {
    /// The bytes are not a line of ours.
    #[error("not a {what} of this program: {problem}")]
    Bytes {
        /// "work" or "result".
        what: &'static str,
        /// How that shows.
        problem: String,
    },
    /// The worker would measure with something else.
    #[error(
        "the worker {worker} would measure with something else than the study:\n{differences}\n\
         install the same version of finger-opt there"
    )]
    OtherSources {
        /// Host and process.
        worker: String,
        /// One line for each difference.
        differences: String,
    },
    /// A result that cannot be right.
    #[error("the result of the worker {worker} is refused: {problem}")]
    Poisoned {
        /// Host and process, as the result says.
        worker: String,
        /// What is wrong with it.
        problem: String,
    },
}

/// Contents and times of a sealed line; `again` writes them anew, and must give the same bytes.
fn read<T: DeserializeOwned, U: DeserializeOwned>(
    bytes: &[u8],
    what: &'static str,
    again: impl Fn(&T, &U) -> Result<String, serde_json::Error>,
) -> Result<(T, U), WorkError> {
    let wrong = |problem: String| WorkError::Bytes { what, problem };
    let text = std::str::from_utf8(bytes).map_err(|error| wrong(error.to_string()))?;
    let line = text.strip_suffix('\n').unwrap_or(text);
    let (contents, times) = unseal(line).map_err(|error| wrong(error.to_string()))?;
    let json = |error: serde_json::Error| wrong(error.to_string());
    let contents: T = serde_json::from_str(&contents).map_err(json)?;
    let times: U = serde_json::from_str(&times).map_err(json)?;
    if again(&contents, &times).map_err(json)? != text {
        return Err(wrong("it contradicts itself".to_owned()));
    }
    Ok((contents, times))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NoTimes {}

impl Work {
    /// As bytes.
    ///
    /// # Errors
    /// If a number in it cannot be written.
    pub fn encode(&self) -> Result<Vec<u8>, WorkError> {
        let line = seal(self, None::<&()>)
            .map_err(|error| WorkError::Bytes { what: "work", problem: error.to_string() })?;
        Ok(line.into_bytes())
    }

    /// The work of these bytes.
    ///
    /// # Errors
    /// If they are none.
    pub fn decode(bytes: &[u8]) -> Result<Work, WorkError> {
        let again = |work: &Work, _: &NoTimes| seal(work, None::<&()>);
        Ok(read(bytes, "work", again)?.0)
    }

    /// What is measured, as the study's course names it.
    pub fn wanted(&self) -> Wanted {
        Wanted { proposal: self.proposal, design: self.design.clone() }
    }

    /// Whether a worker that measures with `own` may do it; `worker` is its host and process.
    ///
    /// # Errors
    /// If it may not; the text says in what they differ.
    pub fn admit(&self, own: &Provenance, worker: &str) -> Result<(), WorkError> {
        match self.provenance.differences(own) {
            Some(differences) if !self.provenance.simulates_like(own) => {
                Err(WorkError::OtherSources { worker: worker.to_owned(), differences })
            }
            _ => Ok(()),
        }
    }

    /// The result as bytes: what the worker of this name measured.
    ///
    /// # Errors
    /// If a number in it cannot be written.
    pub fn done(
        &self,
        measured: Measured,
        timing: &Timing,
        worker: &str,
    ) -> Result<Vec<u8>, WorkError> {
        let done = Done {
            work_sha256: sha256_hex(&self.encode()?),
            source_sha256: self.provenance.source_sha256.clone(),
            worker: worker.to_owned(),
            design: self.design.clone(),
            stiffness: measured.stiffness,
            tasks: measured.tasks,
        };
        let Timing { datetime_start, datetime_complete, wall_s, .. } = timing.clone();
        let times = Times { datetime_start, datetime_complete, wall_s };
        let line = seal(&done, Some(&times))
            .map_err(|error| WorkError::Bytes { what: "result", problem: error.to_string() })?;
        Ok(line.into_bytes())
    }

    /// The result of this work, if it can be one; `stiffness` is what the study's own model
    /// predicts for the design.
    ///
    /// # Errors
    /// If anything about it is wrong.
    pub fn check(&self, bytes: &[u8], stiffness: &Prediction) -> Result<Arrived, WorkError> {
        let again = |done: &Done, times: &Times| seal(done, Some(times));
        let (done, times) = read(bytes, "result", again)?;
        if let Some(problem) = self.problem(&done, &times, stiffness)? {
            return Err(WorkError::Poisoned { worker: done.worker, problem });
        }
        let Times { datetime_start, datetime_complete, wall_s } = times;
        Ok(Arrived {
            proposal: self.proposal,
            measured: Measured { stiffness: *stiffness, tasks: done.tasks, cached: Vec::new() },
            timing: Timing { datetime_start, datetime_complete, wall_s, cached: Vec::new() },
        })
    }

    fn problem(
        &self,
        done: &Done,
        times: &Times,
        stiffness: &Prediction,
    ) -> Result<Option<String>, WorkError> {
        let sources = &self.provenance.source_sha256;
        let json = |prediction: &Prediction| serde_json::to_value(prediction).ok();
        let stamps = [&times.datetime_start, &times.datetime_complete];
        let problem = if done.source_sha256 != *sources {
            format!("it was measured by the sources {}, not by {sources}", done.source_sha256)
        } else if done.design != self.design {
            format!("it is of the design {}, not of {}", done.design, self.design)
        } else if done.work_sha256 != sha256_hex(&self.encode()?) {
            "it is of another work".to_owned()
        } else if json(&done.stiffness) != json(stiffness) {
            "its stiffness is not the one that the study's model predicts".to_owned()
        } else if done.tasks.len() as u64 != self.tasks {
            format!("it has {} tasks in place of {}", done.tasks.len(), self.tasks)
        } else if !stamps.iter().all(|stamp| is_timestamp(stamp)) || !times.wall_s.is_finite() {
            "its times are none".to_owned()
        } else {
            return Ok(done.tasks.iter().find_map(|task| self.contradiction(task)));
        };
        Ok(Some(problem))
    }

    /// What is impossible about an evaluation.
    fn contradiction(&self, found: &Evaluation) -> Option<String> {
        let window = &found.window;
        let numbers = [found.peak_force_n, found.slip_mm, found.simulated_s];
        let numbers = numbers.into_iter().chain(found.end_shares);
        let failed: u32 =
            found.failure_counts.iter().fold(found.diverged, |n, &m| n.saturating_add(m));
        let inserted = window.nominal == Outcome::Inserted;
        let problem = if numbers.into_iter().any(|number| !number.is_finite()) {
            "a number in it is not finite"
        } else if window.negative_steps > 0 || window.positive_steps < 0 {
            "its window does not hold the nominal start"
        } else if failed > found.trials || found.trials == 0 {
            "its trials do not add up"
        } else if !inserted && failed == 0 {
            "its nominal start failed in no trial"
        } else if found.success.is_some() != self.success_rate
            || found.robust.is_some() != self.robust_range
        {
            "it does not have what was asked for"
        } else {
            return None;
        };
        Some(problem.to_owned())
    }
}
