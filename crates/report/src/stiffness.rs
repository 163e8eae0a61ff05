//! Stiffness model of a finger and its leave-one-out errors as table, JSON and plot.

use super::chart::{
    Area, DrawResult, HPos, PlotError, VPos, axes, legend, padded_range, render, text_style,
};
use super::marks::{PointMark, dashed, line, points};
use super::theme::{BLUE, Colour, GREEN, INK, MUTED, ORANGE};
use super::{ReportError, text_table};
use ask_tell::statistics::sorted;
use input::units::N_PER_MM;
use insertion::stiffness::Axis;
use insertion::surrogate::Model;
use insertion::{Estimate, Measurement};
use plotters::prelude::*;
use serde_json::{Value, json};

/// Returns the leave-one-out errors of all candidate models in both directions, and the model chosen for each.
pub fn table(model: &Model) -> String {
    let mut text = format!(
        "Stiffness of one finger, fitted to {}{}.\n\
         Leave-one-out errors e: each design is predicted by a model fitted without it.\n\
         Root mean square, mean magnitude, root mean square in predicted deviations (sd):\n\n",
        model.counted(),
        if model.ratios { " and computed from its ribs" } else { "" },
    );
    let rows = model.loo.iter().map(|row| {
        [
            row.axis.label().to_owned(),
            row.model.label().to_owned(),
            decimals(row.rmse_n_per_mm, 3),
            decimals(row.mean_absolute_percent, 2),
            decimals(row.standardised_rms, 2),
            if row.chosen { "<- used" } else { "" }.to_owned(),
        ]
    });
    text += &text_table(2, ["axis", "model", "RMSE N/mm", "|e| %", "e/sd", ""], rows);
    text.push('\n');
    for axis in Axis::ALL {
        let widening = model.widening(axis);
        let note = if widening > 1.0 {
            format!("standard deviations are widened by {widening:.2} to match the errors above")
        } else if model.measurements.len() == 1 {
            "one finger gives no error; the scatter of the shipped designs is assumed".to_owned()
        } else {
            "standard deviations match the errors above, or are larger".to_owned()
        };
        text += &format!("{}: {}\n  {note}\n", axis.label(), model.describe(axis));
    }
    if model.measurements.len() > 1 {
        text.push_str(
            "The models were chosen by these errors, which are therefore slightly optimistic.\n",
        );
    }
    text
}

/// Formats a number with `places` decimals; a dash if it is not finite.
fn decimals(value: f64, places: usize) -> String {
    if value.is_finite() { format!("{value:.places$}") } else { "-".to_owned() }
}

/// Returns the model chosen for each direction, and the leave-one-out errors of all candidates, as JSON.
pub fn json(model: &Model) -> Value {
    let errors = model.loo.iter().map(|row| {
        json!({
            "axis": if row.axis == Axis::Assembly { "assembly" } else { "compliance" },
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
        "models": errors.collect::<Value>(),
        "used": {"assembly": used(Axis::Assembly), "compliance": used(Axis::Compliance)},
    })
}

/// Draws four panels: the stiffness along y and along z, each against infill direction and density, as curves with a
/// band of one standard deviation, and the measured designs.
pub fn svg(model: &Model) -> Result<String, ReportError> {
    render("the stiffness model", (1160, 880), |area| {
        let (head, body) = area.split_vertically(58);
        let style = |size, colour| text_style(size, colour, HPos::Left, VPos::Top);
        let title = "Stiffness of one finger: model and measurements";
        head.draw_text(title, &style(20, INK), (20, 8))?;
        let note = "band: ± 1 standard deviation of a new finger    filled: measured at the \
                     curve's value    open: measured in between (colour of the nearest curve)    \
                     dashed: limits of the measurements";
        head.draw_text(note, &style(15, MUTED), (20, 36))?;
        let rows = [Axis::Compliance, Axis::Assembly].into_iter();
        let plots = rows.flat_map(|axis| [true, false].map(|by_direction| (axis, by_direction)));
        let mut panels = body.split_evenly((2, 2)).into_iter().zip(plots);
        panels.try_for_each(|(panel, (axis, by_direction))| draw(&panel, model, axis, by_direction))
    })
}

/// Number of steps along a curve, unless the model computes fingers from their ribs.
const SAMPLES: u32 = 80;

/// Colours of the curves.
const SERIES: [Colour; 3] = [BLUE, ORANGE, GREEN];

/// Draws the stiffness along an axis against the infill direction or the infill density.
fn draw(area: &Area<'_>, model: &Model, axis: Axis, by_direction: bool) -> DrawResult {
    // Converts (density, direction) to (value along x, value of the curve), or back.
    let swapped = |(density, direction): (f64, f64)| {
        if by_direction { (direction, density) } else { (density, direction) }
    };
    let of = |m: &Measurement| swapped((m.density_percent, m.direction_deg));
    let predict = |x: f64, curve: f64| {
        let (density, direction) = swapped((x, curve));
        let Estimate { mean, sd } = model.predict([density, direction])?.axis(axis);
        Ok::<_, PlotError>((x, Estimate { mean: mean / N_PER_MM, sd: sd / N_PER_MM }))
    };
    let name = |curve: f64| {
        if by_direction { format!("density {curve} %") } else { format!("direction {curve}°") }
    };
    let measured = &model.measurements;
    let limits = padded_range(measured.iter().map(|m| of(m).0), 0.0);
    let span = limits.end - limits.start;
    let x = (limits.start - 0.15 * span).max(0.0)..limits.end + 0.2 * span;
    let curves = levels(measured.iter().map(|m| of(m).1));
    // A model that computes fingers from their ribs takes a third of a second per point, so its curves are evaluated
    // only at their ends and at the curves of the other panel.
    let places: Vec<f64> = if model.ratios {
        let levels = levels(measured.iter().map(|m| of(m).0));
        [x.start].into_iter().chain(levels).chain([x.end]).collect()
    } else {
        let at = |i| x.start + (x.end - x.start) * f64::from(i) / f64::from(SAMPLES);
        (0..=SAMPLES).map(at).collect()
    };
    let band = |&curve: &f64| places.iter().map(|&x| predict(x, curve)).collect();
    let bands: Vec<Vec<(f64, Estimate)>> =
        curves.iter().map(band).collect::<Result<_, PlotError>>()?;
    let tops = bands.iter().flatten().map(|(_, e)| e.mean + e.sd);
    let readings = measured.iter().map(|m| m.stiffness(axis) / N_PER_MM);
    let mut y = padded_range(tops.chain(readings).chain([0.0]), 0.05);
    y.start = 0.0;
    let top = y.end;
    let label = format!("stiffness in {} (N/mm)", axis.label());
    let x_axis = (if by_direction { "infill direction (°)" } else { "infill density (%)" }, x);
    let mut chart = axes(area, "", x_axis, (&label, y), None)?;
    for limit in [limits.start, limits.end] {
        dashed(&mut chart, [(limit, 0.0), (limit, top)])?;
    }
    for (band, colour) in bands.iter().zip(SERIES) {
        let upper = band.iter().map(|(x, e)| (*x, e.mean + e.sd));
        let lower = band.iter().rev().map(|(x, e)| (*x, (e.mean - e.sd).max(0.0)));
        let outline: Vec<(f64, f64)> = upper.chain(lower).collect();
        chart.draw_series([Polygon::new(outline, colour.rgb.mix(0.15).filled())])?;
    }
    for ((band, colour), &curve) in bands.iter().zip(SERIES).zip(&curves) {
        let means = band.iter().map(|(x, e)| (*x, e.mean)).collect();
        line(&mut chart, means, colour.rgb.stroke_width(2), name(curve))?;
    }
    for m in measured {
        let (x, level) = of(m);
        points(&mut chart, [(x, m.stiffness(axis) / N_PER_MM)], mark(level, &curves), "")?;
    }
    let corner = match axis {
        Axis::Compliance => SeriesLabelPosition::LowerRight,
        Axis::Assembly => SeriesLabelPosition::UpperRight,
    };
    legend(&mut chart, corner)
}

/// Returns a mark in the colour of the nearest curve, filled if the measured design has the curve's value.
fn mark(level: f64, curves: &[f64]) -> PointMark {
    let distances = curves.iter().map(|curve| (curve - level).abs()).zip(SERIES);
    let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0));
    let (distance, colour) = nearest.unwrap_or((f64::INFINITY, MUTED));
    if distance < 1e-9 { PointMark::disc(colour, 5) } else { PointMark::ring(colour, 5, 2) }
}

/// Returns the smallest, middle and largest of the distinct values.
fn levels(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sorted = sorted(values);
    sorted.dedup();
    match sorted.len() {
        0..=3 => sorted,
        n => vec![sorted[0], sorted[n / 2], sorted[n - 1]],
    }
}
