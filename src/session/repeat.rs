//! Repeats of a trial or an evaluation: do small changes change the outcome?

use super::failure::{not_stopped, wide, within};
use super::{Failure, Setup};
use insertion::evaluation::OffsetStep;
use insertion::evaluation::evaluator::Specimen;
use insertion::evaluation::robustness::repeat::Repeats;
use insertion::trial::Grasp;
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

    /// Results of repeats of a finger on its task, from this taught start.
    pub(super) fn of<T>(
        &self,
        setup: &Setup,
        specimen: &Specimen,
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
