//! `optimize stiffness`: how well the stiffness model fits, as table, JSON and plot.

use super::ReportError;
use super::chart::{Area, AxisOf, Chart, Drawn, around, axes, legend, message, sheet};
use super::theme::{BLUE, Colour, GREEN, INK, MUTED, ORANGE};
use crate::input::stiffness::{Axis, Measurement};
use crate::surrogate::{Estimate, Model};
use crate::units::N_PER_MM;
use plotters::prelude::*;
use std::fmt::Write;

/// Leave-one-out errors of every model on both axes, and what was chosen.
pub fn table(model: &Model) -> String {
    let mut text = format!(
        "Stiffness of one finger, fitted to {} measured designs.\n\
         Errors are leave-one-out: each design is predicted by a model that never saw it.\n\n\
         {:<16}{:<34}{:>12}{:>12}{:>14}\n",
        model.measurements().len(),
        "axis",
        "model",
        "RMSE N/mm",
        "mean |e| %",
        "RMS of e/sd",
    );
    for row in model.loo() {
        let chosen = if row.chosen { "  <- used" } else { "" };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<16}{:<34}{:>12.3}{:>12.2}{:>14.2}{chosen}",
            row.axis.label(),
            row.model.label(),
            row.rmse_n_per_mm,
            row.mean_absolute_percent,
            row.standardised_rms,
        );
    }
    text.push('\n');
    for axis in Axis::ALL {
        let _ = writeln!(text, "{}: {}", axis.label(), model.describe(axis));
        let widening = model.widening(axis);
        let note = if widening > 1.0 {
            format!("standard deviations are widened by {widening:.2} to fit the errors above")
        } else {
            "standard deviations fit the errors above, or are larger".to_owned()
        };
        let _ = writeln!(text, "  {note}");
    }
    text.push_str(
        "The choice rests on these same errors, so they flatter the chosen model a little.\n",
    );
    text
}

/// The same as JSON: `designs`, `models` (a list of rows), `used` (per axis).
pub fn json(model: &Model) -> serde_json::Value {
    let key = |axis| match axis {
        Axis::Assembly => "assembly",
        Axis::Compliance => "compliance",
    };
    let rows: Vec<serde_json::Value> = model
        .loo()
        .iter()
        .map(|row| {
            serde_json::json!({
                "axis": key(row.axis),
                "model": row.model.label(),
                "loo_rmse_n_per_mm": row.rmse_n_per_mm,
                "loo_mean_absolute_percent": row.mean_absolute_percent,
                "loo_standardised_rms": row.standardised_rms,
                "used": row.chosen,
            })
        })
        .collect();
    let used = |axis| {
        serde_json::json!({
            "model": model.chosen(axis).map(|row| row.model.label()),
            "parameters": model.describe(axis),
            "sd_widening": model.widening(axis),
        })
    };
    serde_json::json!({
        "designs": model.measurements().len(),
        "models": rows,
        "used": { "assembly": used(Axis::Assembly), "compliance": used(Axis::Compliance) },
    })
}

/// Four panels: both axes of stiffness against direction and against density;
/// curves with a band of one standard deviation, and the measured designs.
///
/// # Errors
/// If the drawing library refuses.
pub fn svg(model: &Model) -> Result<String, ReportError> {
    sheet("the stiffness model", (1160, 880), |area| {
        let (head, body) = area.split_vertically(58);
        let title = super::chart::words(20, INK, LEFT, TOP);
        head.draw_text("Stiffness of one finger: model and measurements", &title, (20, 8))
            .map_err(message)?;
        let note = super::chart::words(15, MUTED, LEFT, TOP);
        let words = "band: ± 1 standard deviation of a new finger    filled: measured at the \
                     curve's value    open: measured in between (colour of the nearest curve)    \
                     dashed: limits of the measurements";
        head.draw_text(words, &note, (20, 36)).map_err(message)?;
        for (panel, (axis, by)) in body.split_evenly((2, 2)).iter().zip(PANELS) {
            draw(panel, model, axis, by)?;
        }
        Ok(())
    })
}

const LEFT: plotters::style::text_anchor::HPos = plotters::style::text_anchor::HPos::Left;
const TOP: plotters::style::text_anchor::VPos = plotters::style::text_anchor::VPos::Top;

/// What a panel has along its x axis.
#[derive(Debug, Clone, Copy, PartialEq)]
enum By {
    Direction,
    Density,
}

const PANELS: [(Axis, By); 4] = [
    (Axis::Compliance, By::Direction),
    (Axis::Compliance, By::Density),
    (Axis::Assembly, By::Direction),
    (Axis::Assembly, By::Density),
];

const SERIES: [Colour; 3] = [BLUE, ORANGE, GREEN];

impl By {
    /// `(value along x, value that tells the curves apart)` of a measurement.
    fn of(self, m: &Measurement) -> (f64, f64) {
        match self {
            By::Direction => (m.direction_deg, m.density_percent),
            By::Density => (m.density_percent, m.direction_deg),
        }
    }

    fn predict(self, model: &Model, axis: Axis, x: f64, curve: f64) -> Estimate {
        let found = match self {
            By::Direction => model.predict(curve, x),
            By::Density => model.predict(x, curve),
        };
        let Estimate { mean, sd } = found.axis(axis);
        Estimate { mean: mean / N_PER_MM, sd: sd / N_PER_MM }
    }

    /// Label of the x axis, and what a curve is called.
    fn labels(self, curve: f64) -> (&'static str, String) {
        match self {
            By::Direction => ("infill direction (°)", format!("density {curve} %")),
            By::Density => ("infill density (%)", format!("direction {curve}°")),
        }
    }
}

fn draw(area: &Area<'_>, model: &Model, axis: Axis, by: By) -> Drawn {
    let measured = model.measurements();
    let limits = around(measured.iter().map(|m| by.of(m).0), 0.0);
    let span = limits.end - limits.start;
    let x = (limits.start - 0.15 * span).max(0.0)..limits.end + 0.2 * span;
    let curves = levels(measured.iter().map(|m| by.of(m).1));
    let samples: Vec<f64> =
        (0..=80).map(|i| x.start + (x.end - x.start) * f64::from(i) / 80.0).collect();
    let bands: Vec<Vec<(f64, Estimate)>> = curves
        .iter()
        .map(|&curve| samples.iter().map(|&x| (x, by.predict(model, axis, x, curve))).collect())
        .collect();
    let tops = bands.iter().flatten().map(|(_, e)| e.mean + e.sd);
    let readings = measured.iter().map(|m| m.stiffness(axis) / N_PER_MM);
    let mut y = around(tops.chain(readings).chain([0.0]), 0.05);
    y.start = 0.0;
    let top = y.end;
    let label = format!("stiffness in {} (N/mm)", axis.label());
    let x_axis = AxisOf { label: by.labels(0.0).0, range: x };
    let mut chart = axes(area, "", x_axis, AxisOf { label: &label, range: y })?;
    for limit in [limits.start, limits.end] {
        let points = [(limit, 0.0), (limit, top)];
        let line = DashedLineSeries::new(points, 4, 4, MUTED.rgb().stroke_width(1));
        chart.draw_series(line).map_err(message)?;
    }
    for (band, colour) in bands.iter().zip(SERIES) {
        let upper = band.iter().map(|(x, e)| (*x, e.mean + e.sd));
        let lower = band.iter().rev().map(|(x, e)| (*x, (e.mean - e.sd).max(0.0)));
        let outline: Vec<(f64, f64)> = upper.chain(lower).collect();
        chart
            .draw_series([Polygon::new(outline, colour.rgb().mix(0.15).filled())])
            .map_err(message)?;
    }
    for ((band, colour), curve) in bands.iter().zip(SERIES).zip(&curves) {
        let style = colour.rgb().stroke_width(2);
        chart
            .draw_series(LineSeries::new(band.iter().map(|(x, e)| (*x, e.mean)), style))
            .map_err(message)?
            .label(by.labels(*curve).1)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], style));
    }
    draw_measured(&mut chart, measured, axis, by, &curves)?;
    let corner = match axis {
        Axis::Compliance => SeriesLabelPosition::LowerRight,
        Axis::Assembly => SeriesLabelPosition::UpperRight,
    };
    legend(&mut chart, corner)
}

fn draw_measured(
    chart: &mut Chart<'_, '_>,
    measured: &[Measurement],
    axis: Axis,
    by: By,
    curves: &[f64],
) -> Drawn {
    for m in measured {
        let (x, curve) = by.of(m);
        let distance = |level: &f64| (level - curve).abs();
        let nearest = (0..curves.len())
            .min_by(|&a, &b| distance(&curves[a]).total_cmp(&distance(&curves[b])));
        let Some(nearest) = nearest else { continue };
        let colour = SERIES[nearest % SERIES.len()].rgb();
        let on_curve = distance(&curves[nearest]) < 1e-9;
        let style = if on_curve { colour.filled() } else { colour.stroke_width(2) };
        let at = (x, m.stiffness(axis) / N_PER_MM);
        chart.draw_series([Circle::new(at, 5, style)]).map_err(message)?;
    }
    Ok(())
}

/// Smallest, middle and largest of the distinct values.
fn levels(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    match sorted.len() {
        0..=3 => sorted,
        n => vec![sorted[0], sorted[n / 2], sorted[n - 1]],
    }
}
