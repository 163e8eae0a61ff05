//! `--repeat N` of `trial` and `evaluate`: do small changes change the outcome?

use super::Failure;
use super::setup::Setup;
use super::specimen::Chosen;
use clap::Args;
use insertion::evaluation::robustness::repeat::{Band, Bands, Repeats};
use insertion::evaluation::{Evaluation, OffsetStep};
use insertion::outcome::Outcome;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// How often.
#[derive(Debug, Clone, Args)]
pub struct RepeatArguments {
    /// Then N times more with friction within 10 %, start within 0.02 mm, and half the step by turns
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    repeat: Option<u32>,
    /// Seed of the repeats
    #[arg(long, value_name = "N", default_value_t = 0, requires = "repeat")]
    repeat_seed: u64,
}

impl RepeatArguments {
    /// The outcomes at one offset, m, and how often each was met; `None` if none is asked for.
    pub fn outcomes(
        &self,
        setup: &Setup,
        chosen: &Chosen,
        (taught, offset): (Option<OffsetStep>, f64),
    ) -> Result<Option<BTreeMap<String, usize>>, Failure> {
        let count = |outcomes: Vec<Outcome>| {
            let mut counts = BTreeMap::new();
            for outcome in outcomes {
                *counts.entry(word(outcome)).or_default() += 1;
            }
            counts
        };
        self.with(setup, chosen, taught, |repeats| count(repeats.outcomes(offset)))
    }

    /// The bands at the ends of a window; `None` if none is asked for.
    pub fn bands(
        &self,
        setup: &Setup,
        chosen: &Chosen,
        measured: &Evaluation,
    ) -> Result<Option<Bands>, Failure> {
        if measured.window.nominal != Outcome::Inserted {
            return Ok(None);
        }
        self.with(setup, chosen, measured.taught, |repeats| repeats.bands(&measured.window))
    }

    fn with<T>(
        &self,
        setup: &Setup,
        chosen: &Chosen,
        taught: Option<OffsetStep>,
        measure: impl Fn(&Repeats) -> T,
    ) -> Result<Option<T>, Failure> {
        let Some(count) = self.repeat else { return Ok(None) };
        let specimen = &chosen.specimen;
        let rig = |factor| setup.evaluator.rig(specimen, taught, factor).map_err(Failure::input);
        let (whole, half) = (rig(1.0)?, rig(0.5)?);
        let repeats = Repeats::new([&*whole, &*half], &specimen.finger, self.repeat_seed, count);
        Ok(Some(measure(&repeats)))
    }
}

/// `inserted`, `failed: jammed` and so on.
fn word(outcome: Outcome) -> String {
    match outcome {
        Outcome::Failed(class) => format!("failed: {}", class.label()),
        outcome => outcome.word().to_owned(),
    }
}

/// `repeats       18 inserted, 2 failed: jammed`.
pub fn outcomes_text(counts: &BTreeMap<String, usize>) -> String {
    let parts: Vec<String> =
        counts.iter().map(|(outcome, count)| format!("{count} {outcome}")).collect();
    format!("repeats       {}\n", parts.join(", "))
}

/// The bands in two lines.
pub fn bands_text(bands: &Bands) -> String {
    let width = |band: &Band| {
        band.width_mm().map_or("more than 2 mm".to_owned(), |width| format!("{width:.1} mm"))
    };
    let inside = match bands.unsure_inside.as_slice() {
        [] => format!("all {} offsets tried insert in every repeat", bands.looked_at_inside),
        unsure => {
            let at: Vec<String> = unsure.iter().map(|mm| format!("{mm:+.1}")).collect();
            let tried = bands.looked_at_inside;
            format!(
                "{} of {tried} offsets tried do not insert in every repeat: {} mm",
                unsure.len(),
                at.join(", ")
            )
        }
    };
    format!(
        "unsure bands  {} below, {} above\nbetween them  {inside}\n",
        width(&bands.negative),
        width(&bands.positive)
    )
}

/// The same as JSON.
pub fn bands_json(bands: &Bands) -> Value {
    json!({
        "negative_band_mm": bands.negative.width_mm(),
        "positive_band_mm": bands.positive.width_mm(),
        "offsets_tried_inside": bands.looked_at_inside,
        "unsure_inside_mm": bands.unsure_inside,
    })
}
