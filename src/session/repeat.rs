//! Repeats of a trial or an evaluation: do small changes change the outcome?

use super::failure::{not_stopped, wide, within};
use super::finger::Chosen;
use super::{Failure, Setup};
use insertion::evaluation::robustness::repeat::{Bands, Repeats};
use insertion::evaluation::{Evaluation, OffsetStep};
use insertion::outcome::Outcome;
use insertion::trial::Grasp;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::atomic::AtomicBool;

const REPEATS: RangeInclusive<u32> = 2..=10_000;

/// How often to repeat, with friction within 10 %, start within 0.02 mm, and half the step by turns.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct RepeatRequest {
    /// Then N times more with friction within 10 %, start within 0.02 mm, and half the step by turns
    #[arg(id = "repeat", long = "repeat", value_name = "N", required = false,
          value_parser = clap::value_parser!(u32).range(wide(&REPEATS)))]
    pub count: u32,
    /// Seed of the repeats
    #[arg(
        id = "repeat_seed",
        long = "repeat-seed",
        value_name = "N",
        default_value_t = 0,
        requires = "repeat"
    )]
    pub seed: u64,
}

impl RepeatRequest {
    /// Whether it can be done so often.
    pub(super) fn check(self) -> Result<(), Failure> {
        within("--repeat", self.count, &REPEATS)
    }

    /// The outcomes at one offset, m, and how often each was met.
    pub(super) fn outcomes(
        &self,
        setup: &Setup,
        chosen: &Chosen,
        (taught, offset): (Option<OffsetStep>, f64),
        stop: &AtomicBool,
    ) -> Result<BTreeMap<String, usize>, Failure> {
        let count = |outcomes: Vec<Outcome>| {
            let mut counts = BTreeMap::new();
            for outcome in outcomes {
                *counts.entry(word(outcome)).or_default() += 1;
            }
            counts
        };
        self.with((setup, chosen), taught, stop, |repeats| count(repeats.outcomes(offset)))
    }

    /// The bands at the ends of a window; `None` if there is no window.
    pub(super) fn bands(
        &self,
        setup: &Setup,
        chosen: &Chosen,
        measured: &Evaluation,
        stop: &AtomicBool,
    ) -> Result<Option<Bands>, Failure> {
        if measured.window.nominal != Outcome::Inserted {
            return Ok(None);
        }
        let bands = |repeats: &Repeats| repeats.bands(&measured.window);
        self.with((setup, chosen), measured.taught, stop, bands).map(Some)
    }

    fn with<T>(
        &self,
        (setup, Chosen { specimen, .. }): (&Setup, &Chosen),
        taught: Option<OffsetStep>,
        stop: &AtomicBool,
        measure: impl Fn(&Repeats) -> T,
    ) -> Result<T, Failure> {
        let rig = |factor| setup.evaluator.rig(specimen, taught, factor).map_err(Failure::input);
        let rigs = [rig(1.0)?, rig(0.5)?];
        let grasp = Grasp { stop, ..Grasp::of(&specimen.finger) };
        let repeats = Repeats::new(rigs.each_ref().map(|rig| &**rig), grasp, self.seed, self.count);
        let measured = measure(&repeats);
        not_stopped(stop)?;
        Ok(measured)
    }
}

/// `inserted`, `failed: jammed` and so on.
fn word(outcome: Outcome) -> String {
    match outcome {
        Outcome::Failed(class) => format!("failed: {}", class.label()),
        outcome => outcome.word().to_owned(),
    }
}
