//! Repeats of a trial or an evaluation with small variations.

use super::Setup;
use crate::{Context, Failure};
use input::counted;
use insertion::evaluation::robustness::repeat::{Band, Bands, Repeats};
use insertion::{OffsetStep, Scenario};
use serde::{Serialize, Serializer};
use serde_json::json;

/// Seed of the repeats.
const SEED: u64 = 0;

/// Number of repeats with small variations of friction, start and step.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct RepeatRequest {
    /// Repeat N times with friction varied within 10 %, start within 0.02 mm, half the step in every other one, and a
    /// cell's numbers drawn
    #[arg(id = "repeat", long = "repeat", value_name = "N", required = false,
          value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub count: u32,
}

impl RepeatRequest {
    /// Calls `measure` with the varied repeats of a scenario from this taught start; returns its result, and the number
    /// of impossible draws of the cell's numbers, which are left out.
    pub(crate) fn run<T>(
        &self,
        setup: &Setup,
        scenario: &Scenario,
        taught: Option<OffsetStep>,
        context: &Context<'_>,
        measure: impl Fn(&Repeats) -> T,
    ) -> Result<(T, usize), Failure> {
        let (evaluator, repeats, stop) = (&setup.evaluator, (SEED, self.count), context.stop);
        let progress = |done_of| context.part("starts of the repeats", done_of, 0.0);
        let (started, impossible) = evaluator.drawn(scenario, taught, repeats, stop, progress)?;
        let measured = evaluator.repeated(&started, repeats, stop, measure)?;
        context.check()?;
        Ok((measured, impossible))
    }
}

/// Returns the number of impossible draws as a line; empty if there are none.
pub fn impossible_text(draws: usize) -> String {
    let left_out = || format!("left out      {} impossible on this task\n", counted(draws, "draw"));
    (draws > 0).then(left_out).unwrap_or_default()
}

/// Returns the bands of offsets at the ends of a window in which repeats have different outcomes, and the number of
/// impossible draws, as lines.
pub fn bands_text((bands, impossible): &(Bands, usize)) -> String {
    let width = |band: &Band| {
        band.width_mm().map_or("more than 2 mm".to_owned(), |width| format!("{width:.1} mm"))
    };
    let inside = match bands.uncertain_inside.as_slice() {
        [] => format!("all {} offsets tried insert in every repeat", bands.tried_inside),
        unsure => {
            let at: Vec<String> = unsure.iter().map(|mm| format!("{mm:+.1}")).collect();
            let (count, tried, at) = (unsure.len(), bands.tried_inside, at.join(", "));
            format!("{count} of {tried} offsets tried do not insert in every repeat: {at} mm")
        }
    };
    let firm = bands.firm_mm().map_or("unknown".to_owned(), |[from, to]| {
        format!("{:.1} mm ({from:+.1} to {to:+.1}), whose ends insert in every repeat", to - from)
    });
    format!(
        "firm          {firm}\nunsure bands  {} below, {} above\nbetween them  {inside}\n{}",
        width(&bands.negative),
        width(&bands.positive),
        impossible_text(*impossible)
    )
}

/// Serializes bands with the keys of `--json`.
///
/// # Errors
/// Those of the serializer.
pub fn serialize_bands<S: Serializer>(
    bands: &Option<(Bands, usize)>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let fields = bands.as_ref().map(|(bands, impossible_draws)| {
        json!({
            "firm_negative_mm": bands.firm_mm().map(|[from, _]| from),
            "firm_positive_mm": bands.firm_mm().map(|[_, to]| to),
            "negative_band_mm": bands.negative.width_mm(),
            "positive_band_mm": bands.positive.width_mm(),
            "offsets_tried_inside": bands.tried_inside,
            "unsure_inside_mm": bands.uncertain_inside,
            "impossible_draws": impossible_draws,
        })
    });
    fields.serialize(serializer)
}
