//! The unit of work of a study that is measured elsewhere: a pure function from bytes to
//! bytes, safe to run twice.
//!
//! A [`Work`] says all that decides a measurement: the design, the texts of the input files,
//! seed, engine with its settings, and the SHA-256 of the program's sources. A worker of other
//! sources refuses it. The [`Done`] that comes back names the work by its SHA-256 and holds
//! evaluations in their one form. Both are a line of JSON closed by its check, as in journals.
//! Nothing of a result is believed before [`Work::check`] has looked at it.

use super::course::Arrived;
use super::folder::Inputs;
use super::plausible;
use super::provenance::Provenance;
use super::record::Timing;
use super::seal::{seal, sha256_hex, unseal};
use insertion::evaluation::Evaluation;
use insertion::evaluation::evaluator::Measured;
use insertion::evaluation::robustness::race::Race;
use insertion::space::Design;
use insertion::surrogate::Prediction;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};
use std::fmt::Display;

/// A design, and all that decides what is measured of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Work {
    pub proposal: u64,
    /// The design, in the units its keys carry.
    pub design: Design,
    /// Seed of the drawn errors.
    pub seed: u64,
    /// Whether the success rate under drawn errors is measured.
    pub success_rate: bool,
    /// Whether the robust range under drawn errors is measured.
    pub robust_range: bool,
    /// Race for the success rate, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub race: Option<Race>,
    /// How many tasks there are.
    pub tasks: u64,
    /// Provenance that it is to be measured with.
    pub provenance: Provenance,
    /// Texts of the input files by role.
    pub inputs: Inputs,
}

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

/// Why a work was not done, or its result is not believed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct WorkError(String);

impl WorkError {
    fn bytes(what: &str, problem: impl Display) -> Self {
        WorkError(format!("not a {what} of this program: {problem}"))
    }
}

/// Contents and times of a sealed line; `again` writes them anew, and must give the same bytes.
fn read<T: DeserializeOwned, U: DeserializeOwned>(
    bytes: &[u8],
    what: &str,
    again: impl Fn(&T, &U) -> Result<String, serde_json::Error>,
) -> Result<(T, U), WorkError> {
    let json = |error: serde_json::Error| WorkError::bytes(what, error);
    let text = std::str::from_utf8(bytes).map_err(|error| WorkError::bytes(what, error))?;
    let line = text.strip_suffix('\n').unwrap_or(text);
    let (contents, times) = unseal(line).map_err(|error| WorkError::bytes(what, error))?;
    let contents: T = serde_json::from_str(&contents).map_err(json)?;
    let times: U = serde_json::from_str(&times).map_err(json)?;
    if again(&contents, &times).map_err(json)? != text {
        return Err(WorkError::bytes(what, "it contradicts itself"));
    }
    Ok((contents, times))
}

impl Work {
    pub fn encode(&self) -> Result<Vec<u8>, WorkError> {
        let line = seal(self, None);
        Ok(line.map_err(|error| WorkError::bytes("work", error))?.into_bytes())
    }

    pub fn decode(bytes: &[u8]) -> Result<Work, WorkError> {
        let again = |work: &Work, _: &IgnoredAny| seal(work, None);
        Ok(read(bytes, "work", again)?.0)
    }

    /// Whether a worker that measures with `own` may do it; `worker` is its host and process.
    ///
    /// # Errors
    /// If it may not; the text says in what they differ.
    pub fn admit(&self, own: &Provenance, worker: &str) -> Result<(), WorkError> {
        match self.provenance.differences(own) {
            Some(differences) if !self.provenance.simulates_like(own) => Err(WorkError(format!(
                "the worker {worker} would measure with something else than the study:\n\
                     {differences}\ninstall the same version of finger-opt there"
            ))),
            _ => Ok(()),
        }
    }

    /// The result as bytes: what the worker of this name measured.
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
        let timing = Timing { cached: Vec::new(), ..timing.clone() };
        let line = seal(&done, Some(&timing));
        Ok(line.map_err(|error| WorkError::bytes("result", error))?.into_bytes())
    }

    /// The result of this work, if it can be one; `stiffness` is what the study's own model
    /// predicts for the design.
    pub fn check(&self, bytes: &[u8], stiffness: &Prediction) -> Result<Arrived, WorkError> {
        // What a worker took from its own cache it does not say.
        let again = |done: &Done, timing: &Timing| {
            seal(done, Some(&Timing { cached: Vec::new(), ..timing.clone() }))
        };
        let (done, timing) = read(bytes, "result", again)?;
        if let Some(problem) = self.problem(&done, &timing, stiffness)? {
            let worker = done.worker;
            let problem = format!("the result of the worker {worker} is refused: {problem}");
            return Err(WorkError(problem));
        }
        Ok(Arrived {
            proposal: self.proposal,
            measured: Measured { stiffness: *stiffness, tasks: done.tasks, cached: Vec::new() },
            timing,
        })
    }

    fn problem(
        &self,
        done: &Done,
        timing: &Timing,
        stiffness: &Prediction,
    ) -> Result<Option<String>, WorkError> {
        let sources = &self.provenance.source_sha256;
        let json = |prediction: &Prediction| serde_json::to_value(prediction).ok();
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
        } else {
            let asked = [self.success_rate, self.robust_range];
            let doubtful = done.tasks.iter().find_map(|found| {
                match asked == [found.success.is_some(), found.robust.is_some()] {
                    true => plausible::implausible(found).or_else(|| self.race_problem(found)),
                    false => Some("it does not have what was asked for"),
                }
            });
            return Ok(doubtful.or_else(|| timing.implausible()).map(str::to_owned));
        };
        Ok(Some(problem))
    }

    fn race_problem(&self, found: &Evaluation) -> Option<&'static str> {
        let success = found.success.as_ref()?;
        let can_be = match &self.race {
            Some(race) => race.can_end_in(success),
            None => success.raced().is_none(),
        };
        (!can_be).then_some("its race cannot have ended so")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fits;
    use crate::plausible::tests::{BOUNDS, sound};
    use crate::record::Recorded;
    use crate::{decode, encode};
    use insertion::evaluation::SuccessRate;
    use insertion::evaluation::objective::{Goals, Measure};
    use insertion::space::Space;
    use insertion::trial::engine::EngineKind;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    fn work() -> Work {
        Work {
            proposal: 0,
            design: Design::infill(20.0, 10.0),
            seed: 0,
            success_rate: false,
            robust_range: false,
            race: None,
            tasks: 1,
            provenance: Provenance::new(EngineKind::Direct, BTreeMap::new()),
            inputs: Inputs::new(),
        }
    }

    fn timing(wall_s: f64) -> Timing {
        let stamp = "2026-01-02T03:04:05.678901".to_owned();
        Timing { datetime_start: stamp.clone(), datetime_complete: stamp, wall_s, cached: vec![] }
    }

    /// Whether a result with these numbers is taken; if it is, its line is read again.
    fn taken(evaluation: Evaluation, wall_s: f64) -> bool {
        taken_from(work(), evaluation, wall_s)
    }

    fn taken_from(work: Work, evaluation: Evaluation, wall_s: f64) -> bool {
        let (success_rate, robust_range) =
            (evaluation.success.is_some(), evaluation.robust.is_some());
        let work = Work { success_rate, robust_range, ..work };
        let stiffness = Prediction::exact(3e3, 2e4);
        let measured = Measured { stiffness, tasks: vec![evaluation], cached: Vec::new() };
        let bytes = work.done(measured, &timing(wall_s), "a worker").unwrap();
        let Ok(Arrived { measured, timing, .. }) = work.check(&bytes, &stiffness) else {
            return false;
        };
        let goals = Goals::of(Measure::Range);
        let tasks = measured.tasks;
        let score = goals.score(&tasks.iter().collect::<Vec<_>>()).filter(fits::sound);
        let (design, refused) = (work.design.clone(), None);
        let recorded =
            Recorded { index: 0, proposal: None, design, score, stiffness, tasks, timing, refused };
        let space = include_str!("../../../spaces/infill.toml");
        let space = Space::parse(space, "infill.toml").unwrap();
        let mut read = decode(encode(&recorded, &space).unwrap().trim_end(), 0).unwrap();
        fits::refuse_doubtful(&mut read, &goals);
        assert_eq!(read.refused, None);
        true
    }

    #[test]
    fn a_race_that_did_not_end_so_is_refused() {
        let race = Race { bar_share: 0.75, draws: 8, first: vec![6, 2] };
        let work = Work { race: Some(race), ..work() };
        let again = Work::decode(&work.encode().unwrap()).unwrap();
        assert_eq!(again, work);
        let ended = |inserted, failed_draws: &[u32], spared| {
            let failure_counts = [failed_draws.len() as u32, 0, 0, 0];
            let counts = SuccessRate { inserted, failure_counts, spared, ..SuccessRate::default() };
            let success = Some(SuccessRate { failed_draws: failed_draws.to_vec(), ..counts });
            taken_from(work.clone(), Evaluation { success, ..sound() }, 1.0)
        };
        // What else cannot be is a matter of the race: tests/race.rs.
        assert!(ended(0, &[0, 2, 6], 5) && ended(6, &[2, 6], 0));
        assert!(!ended(1, &[2, 6], 5), "it had not lost yet");
    }

    proptest! {
        /// All numbers of the schema, at their bounds, around them and far beyond.
        #[test]
        fn what_is_taken_from_a_worker_can_be_read_again(
            at in 0..BOUNDS.len(),
            near in prop::sample::select(vec![0, 1]),
            away in prop::sample::select(vec![0.0, 1e-9, 1.0, -1.0, 1e3, -1e3, 1e17, -1e17, f64::NAN]),
            wall_s in prop::sample::select(vec![0.0, 1.0, -1e-9, 1e300, f64::INFINITY, f64::NAN]),
        ) {
            let (_, change, bounds) = BOUNDS[at];
            let mut evaluation = sound();
            let value = bounds[near] + away;
            change(&mut evaluation, value);
            // What is no number is not written as one.
            let raced = evaluation.success.as_ref().is_some_and(|success| success.raced().is_some());
            let sound = plausible::implausible(&evaluation).is_none() && (0.0..f64::INFINITY).contains(&wall_s) && !raced;
            let taken = taken(evaluation, wall_s);
            prop_assert!(taken == sound || value.is_nan(), "{value}, {wall_s} s");
        }
    }
}
