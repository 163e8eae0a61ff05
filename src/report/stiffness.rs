//! `optimize stiffness`: how well the stiffness model fits, as table, JSON and plot.

use insertion::stiffness::Axis;
use insertion::surrogate::Model;
use serde_json::{Value, json};
use std::fmt::Write;

pub use super::stiffness_plot::svg;

/// Leave-one-out errors of every model on both axes, and what was chosen.
pub fn table(model: &Model) -> String {
    let mut text = format!(
        "Stiffness of one finger, fitted to {}{}.\n\
         Errors are leave-one-out: each design is predicted by a model that never saw it.\n\n\
         {:<16}{:<34}{:>12}{:>12}{:>14}\n",
        model.counted(),
        if model.ratios { " and computed from its ribs" } else { "" },
        "axis",
        "model",
        "RMSE N/mm",
        "mean |e| %",
        "RMS of e/sd",
    );
    for row in &model.loo {
        let chosen = if row.chosen { "  <- used" } else { "" };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<16}{:<34}{:>12}{:>12}{:>14}{chosen}",
            row.axis.label(),
            row.model.label(),
            decimals(row.rmse_n_per_mm, 3),
            decimals(row.mean_absolute_percent, 2),
            decimals(row.standardised_rms, 2),
        );
    }
    text.push('\n');
    for axis in Axis::ALL {
        let _ = writeln!(text, "{}: {}", axis.label(), model.describe(axis));
        let widening = model.widening(axis);
        let note = if widening > 1.0 {
            format!("standard deviations are widened by {widening:.2} to fit the errors above")
        } else if model.measurements.len() == 1 {
            "one finger leaves no error; scatter as of the shipped designs is assumed".to_owned()
        } else {
            "standard deviations fit the errors above, or are larger".to_owned()
        };
        let _ = writeln!(text, "  {note}");
    }
    if model.measurements.len() > 1 {
        text.push_str(
            "The choice rests on these same errors, so they flatter the chosen model a little.\n",
        );
    }
    text
}

/// A number, or a dash where there is none.
pub(super) fn decimals(value: f64, places: usize) -> String {
    if value.is_finite() { format!("{value:.places$}") } else { "-".to_owned() }
}

pub(super) fn key(axis: Axis) -> &'static str {
    match axis {
        Axis::Assembly => "assembly",
        Axis::Compliance => "compliance",
    }
}

/// The same as JSON: `designs`, `models` (a list, one of each axis and model), `used` (per axis).
pub fn json(model: &Model) -> Value {
    let models = model.loo.iter().map(|row| {
        json!({
            "axis": key(row.axis),
            "model": row.model.label(),
            "loo_rmse_n_per_mm": row.rmse_n_per_mm,
            "loo_mean_absolute_percent": row.mean_absolute_percent,
            "loo_standardised_rms": row.standardised_rms,
            "used": row.chosen,
        })
    });
    let used = |axis| {
        json!({
            "model": model.chosen(axis).map(|row| row.model.label()),
            "parameters": model.describe(axis),
            "sd_widening": model.widening(axis),
        })
    };
    json!({
        "designs": model.measurements.len(),
        "models": models.collect::<Vec<_>>(),
        "used": { "assembly": used(Axis::Assembly), "compliance": used(Axis::Compliance) },
    })
}
