//! The tolerance window of one finger.

use super::failure::not_stopped;
use super::finger::{Chosen, FingerRequest};
use super::repeat::RepeatRequest;
use super::request::SetupRequest;
use super::{Failure, Setup};
use insertion::evaluation::Evaluation;
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::robustness::repeat::Bands;
use insertion::evaluation::tolerance::Search;
use insertion::outcome::Outcome;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use study::ByRibs;

/// Which finger to measure on which task, and how.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct EvaluateRequest {
    /// Task, robot, finger model; one task.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// The finger.
    #[command(flatten)]
    pub finger: FingerRequest,
    /// Go step by step to the first failure: sees gaps narrower than 0.5 mm, three times the trials
    #[arg(long)]
    pub walk: bool,
    /// Success rate and robust range under these errors, too: typical, or the path of a file
    #[arg(long, value_name = "NAME")]
    pub uncertainty: Option<String>,
    /// Seed of the drawn errors: those of the study with this seed
    #[arg(long, value_name = "N", default_value_t = 0, requires = "uncertainty")]
    pub seed: u64,
    /// Repeats at the window's ends.
    #[command(flatten)]
    pub repeat: Option<RepeatRequest>,
    /// Whether to measure it once more from its ribs, unless a finger model was asked for: on which
    /// of the two the bench agrees depends on the task (`docs/notes/finger.md`).
    #[arg(skip = true)]
    pub by_ribs: bool,
}

/// Measurements of a finger.
pub struct Evaluated {
    /// The finger on its task.
    pub chosen: Chosen,
    /// Its window.
    pub evaluation: Evaluation,
    /// Where the outcome at the window's ends is unsure, if that was asked for and there is a window.
    pub bands: Option<Bands>,
    /// The same finger with springs computed from its ribs, if that was asked for.
    pub by_ribs: Option<ByRibs>,
    /// Wall-clock duration of the evaluation, s.
    pub wall_s: f64,
}

impl EvaluateRequest {
    /// Measures the finger.
    pub fn run(&self, stop: &AtomicBool) -> Result<Evaluated, Failure> {
        self.repeat.map_or(Ok(()), RepeatRequest::check)?;
        let (setup, plan) = self.prepared()?;
        let chosen = self.finger.choose(&setup)?;
        let clock = Instant::now();
        let evaluation = setup.evaluator.measure(&chosen.specimen, self.search(), &plan, stop);
        let evaluation = evaluation.map_err(Failure::input)?;
        not_stopped(stop)?;
        let wall_s = clock.elapsed().as_secs_f64();
        let window = &evaluation.window;
        let bands = |repeat: RepeatRequest| {
            let (specimen, taught) = (&chosen.specimen, evaluation.taught);
            repeat.of(&setup, specimen, taught, stop, |repeats| repeats.bands(window))
        };
        let repeat = self.repeat.filter(|_| window.nominal == Outcome::Inserted);
        let bands = repeat.map(bands).transpose()?;
        let by_ribs = self.by_ribs(&setup, &chosen, stop)?;
        Ok(Evaluated { chosen, evaluation, bands, by_ribs, wall_s })
    }

    /// All that is needed beside the finger.
    pub(super) fn prepared(&self) -> Result<(Setup, Plan), Failure> {
        let mut setup = self.setup.setup()?;
        if let Some(name) = &self.uncertainty {
            setup = setup.under_named(name)?;
        }
        let plan = setup.plan(self.seed, |_| setup.uncertainty.is_some())?;
        Ok((setup, plan))
    }

    pub(super) fn search(&self) -> Search {
        if self.walk { Search::Walk } else { Search::Strides }
    }

    /// Measures the finger once more, from its ribs, with the start taught where the task's own does
    /// not insert; nothing if a finger model was asked for, if the finger is given by its springs, or
    /// if the engine has no such fingers.
    fn by_ribs(
        &self,
        setup: &Setup,
        chosen: &Chosen,
        stop: &AtomicBool,
    ) -> Result<Option<ByRibs>, Failure> {
        if !self.by_ribs || self.setup.finger_model.kind.is_some() || chosen.given {
            return Ok(None);
        }
        let Some(evaluator) = setup.by_ribs() else { return Ok(None) };
        let measured = self.finger.by(setup, &evaluator).and_then(|Chosen { specimen, .. }| {
            let found = evaluator.measure_or_teach(&specimen, self.search(), &Plan::WINDOW, stop);
            found.map_err(Failure::input)
        });
        not_stopped(stop)?;
        Ok(Some(match measured {
            Ok(evaluation) => ByRibs::Measured(vec![evaluation]),
            Err(failure) => ByRibs::Refused(failure.to_string()),
        }))
    }
}
