//! Identification of a cell (robot, grip, plug and socket) from logs of insertion attempts, as JSON, text and a page.

mod page;
#[cfg(test)]
mod tests;

pub use page::html;

use crate::answer::words::number;
use crate::text_table;
use calibration::identify::formulas::{Flange, Friction};
use calibration::identify::misfit::{Misfit, Validation, misfits};
use calibration::identify::question::{Compared, IdentificationResult};
use calibration::identify::unknown::{Unknown, ValueOrigin};
use input::units::{MM, N_PER_MM};
use insertion::Estimate;
use serde_json::{Map, Value, json};

/// Warning if fewer attempts are simulated to end as measured than before the identification.
const FEWER: &str = "fewer end as measured than before: do not trust predictions of this cell";
/// What the logs do not show.
const RANGES: &str = "not validated by these logs: `optimize calibrate` predicts them with intervals, \
                      and counts the measured fingers within theirs";

/// Axes of the task's frame.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Returns the result as JSON.
pub fn json(result: &IdentificationResult) -> Value {
    let found = &result.found;
    let axis = |(name, flange): (&str, &Option<Flange>)| {
        let flange = flange.as_ref()?;
        let numbers = json!({
            "stiffness_n_per_mm": flange.stiffness.mean / N_PER_MM,
            "stiffness_sd_n_per_mm": flange.stiffness.sd / N_PER_MM,
            "damping_n_s_per_m": flange.damping,
            "mass_kg": flange.mass,
            "delay_s": flange.delay_s,
            "explained": flange.explained,
        });
        Some((name.to_owned(), numbers))
    };
    let robot: Map<_, _> = AXES.into_iter().zip(&found.flange).filter_map(axis).collect();
    let probe = |(file, friction): &(String, Friction)| {
        json!({
            "log": file,
            "friction": friction.coefficient.map(|one| one.mean),
            "friction_sd": friction.coefficient.map(|one| one.sd),
            "slides": friction.slides,
        })
    };
    let attempt = |one: &Compared| {
        json!({
            "log": one.logged.file,
            "offset_mm": one.logged.offset / MM,
            "outcome_before": one.before.1.word(),
            "outcome_after": one.after.1.word(),
        })
    };
    json!({
        "task": result.task,
        "remarks": result.remarks,
        "robot": robot,
        "preload_mm": found.preload.map(|preload| preload.mean / MM),
        "preload_sd_mm": found.preload.map(|preload| preload.sd / MM),
        "probes": found.probes.iter().map(probe).collect::<Value>(),
        "unknowns": found.unknowns.iter().map(identified).collect::<Value>(),
        "misfit": found.smoothed.misfit,
        "compared_share": found.smoothed.compared,
        "phases": misfits(&found.compared),
        "attempts": found.compared.iter().map(attempt).collect::<Value>(),
        "validation": Validation::of(found),
    })
}

/// Returns a parameter of the cell, before and after the identification, as JSON.
fn identified(Unknown { prior, posterior, remaining_sd, from, advice }: &Unknown) -> Value {
    json!({
        "name": posterior.name,
        "sets": posterior.path,
        "as": posterior.transform,
        "prior_low": prior.low,
        "prior_high": prior.high,
        "value": posterior.middle(),
        "sd": posterior.sd,
        "from": from,
        "source": posterior.source,
        "expected_share_of_prior_sd": remaining_sd.map(|[expected, _]| expected),
        "share_of_prior_sd": remaining_sd.map(|[_, actual]| actual),
        "advice": advice,
    })
}

/// Returns the result as text for a terminal.
pub fn text(result: &IdentificationResult) -> String {
    let found = &result.found;
    let mut text = String::new();
    for remark in &result.remarks {
        text += &format!("{}{remark}\n", if remark.serious { "warning: " } else { "note: " });
    }
    text += &format!("task          {}\n", result.task);
    for (axis, flange) in AXES.into_iter().zip(&found.flange) {
        let words = match flange {
            Some(Flange { stiffness: Estimate { mean, sd }, .. }) => {
                format!("{:.2} ± {}", mean / N_PER_MM, number(sd / N_PER_MM, 2, "N/mm"))
            }
            None => "not identifiable from these logs".to_owned(),
        };
        text += &format!("robot, {axis}      {words}\n");
    }
    let numbers = found.unknowns.iter().map(|Unknown { prior, posterior, from, .. }| {
        let identified = posterior.value.is_some();
        let after = if identified { page::amount(posterior) } else { "as before".to_owned() };
        [posterior.name.clone(), page::amount(prior), after, origin(*from).to_owned()]
    });
    text += "\n";
    text += &text_table(4, ["number", "prior", "identified", "from"], numbers);
    let advice = |one: &Unknown| Some(format!("\n{}: {}", one.posterior.name, one.advice?));
    text.extend(found.unknowns.iter().filter_map(advice));
    text += &format!("\nmisfit        {}\n", page::misfit_of_fit(&found.smoothed));
    let (outcomes, worse) = page::outcomes(&found.compared);
    text += &format!("outcomes      {outcomes}\n");
    if worse {
        text += &format!("warning: {FEWER}\n");
    }
    text += &format!("ranges        {RANGES}\n");
    if let Some(one) = Validation::of(found) {
        let warning = if one.is_doubtful() { "warning: " } else { "" };
        text += &format!("{warning}{}\n", validated(&one));
    }
    text.extend(unmodelled(&found.compared).iter().map(|one| format!("warning: {one}\n")));
    text
}

/// Returns the origin of a value in words.
fn origin(from: ValueOrigin) -> &'static str {
    match from {
        ValueOrigin::Formula => "formula",
        ValueOrigin::Fit => "fit",
        ValueOrigin::Prior => "not identifiable",
        ValueOrigin::Files => "not fitted",
    }
}

/// Returns a sentence on the attempt that was held out of the fit for validation.
fn validated(one: &Validation) -> String {
    let Validation { log, offset_mm, outcome, outcome_predicted, misfit, misfit_fitted } = one;
    let means = if one.is_doubtful() { "; do not trust predictions of this cell" } else { "" };
    format!(
        "An attempt that was not fitted ({log}, start {offset_mm:+.1} mm): {outcome}, predicted {outcome_predicted}; \
         misfit of the force {misfit:.2}, of the fitted attempts {misfit_fitted:.2}{means}."
    )
}

/// Returns a sentence on each phase and force component with a misfit of more than 3 standard deviations.
fn unmodelled(compared: &[Compared]) -> Vec<String> {
    let unexplained = misfits(compared).into_iter().filter(|one| one.after > 3.0);
    let sentence = |one: Misfit| {
        let Misfit { phase, axis, after, .. } = one;
        format!(
            "the model does not explain these curves: phase {phase}, {axis}: misfit {after:.1} standard deviations"
        )
    };
    unexplained.map(sentence).collect()
}

/// Formats a number with three significant digits, but all digits before the point and at most four decimals.
fn short(value: f64) -> String {
    let digits = (2.0 - libm::log10(value.abs().max(1e-3)).floor()).clamp(0.0, 4.0);
    format!("{value:.0$}", digits as usize)
}
