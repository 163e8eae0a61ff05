//! Result of an identification from logs, as JSON, text and a page.

mod page;
#[cfg(test)]
mod tests;

pub use page::html;

use crate::answer::words::number;
use crate::text_table;
use calibration::identify::formulas::Flange;
use calibration::identify::misfit::{Misfit, misfits};
use calibration::identify::question::{Compared, IdentifyDone};
use calibration::identify::unknown::{From, Unknown};
use input::units::{MM, N_PER_MM};
use insertion::surrogate::Estimate;
use serde_json::{Value, json};

const AXES: [&str; 3] = ["x", "y", "z"];

/// All of it, with units in the keys.
pub fn json(done: &IdentifyDone) -> Value {
    let found = &done.found;
    let remark = |remark: &calibration::identify::check::Remark| {
        json!({
            "log": remark.file, "lines": remark.lines, "text": remark.text, "serious": remark.serious
        })
    };
    let flange = |(axis, flange): (&str, &Option<Flange>)| {
        let flange = flange.as_ref()?;
        let values = json!({
            "stiffness_n_per_mm": flange.stiffness.mean / N_PER_MM,
            "stiffness_sd_n_per_mm": flange.stiffness.sd / N_PER_MM,
            "damping_n_s_per_m": flange.damping,
            "mass_kg": flange.mass,
            "delay_s": flange.delay_s,
            "explained": flange.explained,
        });
        Some((axis.to_owned(), values))
    };
    let probe = |(file, friction): &(String, calibration::identify::formulas::Friction)| {
        json!({
            "log": file,
            "friction": friction.coefficient.map(|one| one.mean),
            "friction_sd": friction.coefficient.map(|one| one.sd),
            "slides": friction.slides.iter().map(|slide| json!({
                "tangential_over_normal": slide.ratio, "rising": slide.rising
            })).collect::<Vec<_>>(),
        })
    };
    let flange = AXES.into_iter().zip(&found.flange).filter_map(flange);
    json!({
        "task": done.task,
        "remarks": done.remarks.iter().map(remark).collect::<Vec<_>>(),
        "robot": flange.collect::<serde_json::Map<_, _>>(),
        "preload_mm": found.preload.map(|preload| preload.mean / MM),
        "preload_sd_mm": found.preload.map(|preload| preload.sd / MM),
        "probes": found.probes.iter().map(probe).collect::<Vec<_>>(),
        "unknowns": found.unknowns.iter().map(unknown).collect::<Vec<_>>(),
        "misfit": found.smoothed.misfit,
        "compared_share": found.smoothed.compared,
        "phases": misfits(&found.compared),
        "attempts": found.compared.iter().map(|one| json!({
            "log": one.logged.file,
            "offset_mm": one.logged.offset / MM,
            "outcome_before": one.before.1.word(),
            "outcome_after": one.after.1.word(),
        })).collect::<Vec<_>>(),
    })
}

fn unknown(one: &Unknown) -> Value {
    let Unknown { prior, posterior, left, from, advice } = one;
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
        "expected_share_of_prior_sd": left.map(|[expected, _]| expected),
        "share_of_prior_sd": left.map(|[_, left]| left),
        "advice": advice,
    })
}

/// Lines for a terminal.
pub fn text(done: &IdentifyDone) -> String {
    let found = &done.found;
    let mut text = String::new();
    for remark in &done.remarks {
        text += &format!("{}{remark}\n", if remark.serious { "warning: " } else { "note: " });
    }
    text += &format!("task          {}\n", done.task);
    for (axis, flange) in AXES.into_iter().zip(&found.flange) {
        let words = match flange {
            Some(Flange { stiffness: Estimate { mean, sd }, .. }) => {
                format!("{:.2} ± {}", mean / N_PER_MM, number(sd / N_PER_MM, 2, "N/mm"))
            }
            None => "not told by these logs".to_owned(),
        };
        text += &format!("robot, {axis}      {words}\n");
    }
    let numbers = found.unknowns.iter().map(|Unknown { prior, posterior, from, .. }| {
        let told = posterior.value.is_some();
        let after = if told { page::amount(posterior) } else { "as before".to_owned() };
        [posterior.name.clone(), page::amount(prior), after, origin(*from).to_owned()]
    });
    text += "\n";
    text += &text_table(4, ["number", "prior", "identified", "from"], numbers);
    for Unknown { posterior, advice, .. } in &found.unknowns {
        if let Some(advice) = advice {
            text += &format!("\n{}: {advice}", posterior.name);
        }
    }
    let misfit = &found.smoothed.misfit;
    if let (Some(first), Some(last)) = (misfit.first(), misfit.last()) {
        text += &format!(
            "\nmisfit        {first:.2} to {last:.2} deviations over the rounds; {:.0} % of the data compared\n",
            100.0 * found.smoothed.compared
        );
    }
    for one in unmodelled(&found.compared) {
        text += &format!("warning: {one}\n");
    }
    text
}

/// Where a value comes from, in words.
fn origin(from: From) -> &'static str {
    match from {
        From::Formula => "formula",
        From::Fit => "fit",
        From::Prior => "not told",
        From::Files => "not fitted",
    }
}

/// A sentence on each phase and force that stays off with what was identified.
fn unmodelled(compared: &[Compared]) -> Vec<String> {
    let off = misfits(compared).into_iter().filter(|one| one.after > 3.0);
    let words = |one: Misfit| {
        let Misfit { phase, axis, after, .. } = one;
        format!(
            "the model cannot make these curves: phase {phase}, {axis}: off by {after:.1} deviations"
        )
    };
    off.map(words).collect()
}

/// Three digits.
fn short(value: f64) -> String {
    let digits = (2.0 - libm::log10(value.abs().max(1e-3)).floor()).clamp(0.0, 4.0);
    format!("{value:.0$}", digits as usize)
}
