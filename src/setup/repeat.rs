//! Repeats of a trial or an evaluation with small variations.

use super::Setup;
use crate::context::not_stopped;
use crate::failure::Failure;
use insertion::evaluation::OffsetStep;
use insertion::evaluation::evaluator::Scenario;
use insertion::evaluation::robustness::repeat::{Band, Bands, Repeats};
use serde::{Serialize, Serializer};
use serde_json::json;
use std::sync::atomic::AtomicBool;

/// Number and seed of repeats with small variations of friction, start and step.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct RepeatRequest {
    /// Repeat N times with friction varied within 10 %, start within 0.02 mm, half the step in every other one, and a
    /// cell's numbers drawn
    #[arg(id = "repeat", long = "repeat", value_name = "N", required = false,
          value_parser = clap::value_parser!(u32).range(2..=10_000))]
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
    /// Calls `measure` with the varied repeats of a scenario from this taught start, and returns its result.
    pub(crate) fn run<T>(
        &self,
        setup: &Setup,
        scenario: &Scenario,
        taught: Option<OffsetStep>,
        stop: &AtomicBool,
        measure: impl Fn(&Repeats) -> T,
    ) -> Result<T, Failure> {
        let (evaluator, repeats) = (&setup.evaluator, (self.seed, self.count));
        let started = evaluator.drawn(scenario, taught, repeats, stop).map_err(Failure::input)?;
        let measured = evaluator.repeated(&started, repeats, stop, measure);
        let measured = measured.map_err(Failure::input)?;
        not_stopped(stop)?;
        Ok(measured)
    }
}

/// Returns the bands of offsets at the ends of a window in which repeats have different outcomes, as lines.
pub fn bands_text(bands: &Bands) -> String {
    let width = |band: &Band| {
        band.width_mm().map_or("more than 2 mm".to_owned(), |width| format!("{width:.1} mm"))
    };
    let inside = match bands.uncertain_inside.as_slice() {
        [] => format!("all {} offsets tried insert in every repeat", bands.tried_inside),
        unsure => {
            let at: Vec<String> = unsure.iter().map(|mm| format!("{mm:+.1}")).collect();
            let tried = bands.tried_inside;
            format!(
                "{} of {tried} offsets tried do not insert in every repeat: {} mm",
                unsure.len(),
                at.join(", ")
            )
        }
    };
    let firm = bands.firm_mm().map_or("unknown".to_owned(), |[from, to]| {
        format!("{:.1} mm ({from:+.1} to {to:+.1}), whose ends insert in every repeat", to - from)
    });
    format!(
        "firm          {firm}\nunsure bands  {} below, {} above\nbetween them  {inside}\n",
        width(&bands.negative),
        width(&bands.positive)
    )
}

/// Serializes bands with the keys of `--json`.
///
/// # Errors
/// Those of the serializer.
pub fn serialize_bands<S: Serializer>(
    bands: &Option<Bands>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let fields = bands.as_ref().map(|bands| {
        json!({
            "firm_negative_mm": bands.firm_mm().map(|[from, _]| from),
            "firm_positive_mm": bands.firm_mm().map(|[_, to]| to),
            "negative_band_mm": bands.negative.width_mm(),
            "positive_band_mm": bands.positive.width_mm(),
            "offsets_tried_inside": bands.tried_inside,
            "unsure_inside_mm": bands.uncertain_inside,
        })
    });
    fields.serialize(serializer)
}
