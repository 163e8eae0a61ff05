//! Best so far, and each value, against evaluations.

use super::ReportError;
use super::chart::{Area, AxisOf, Drawn, around, axes, legend, message, sheet, words};
use super::theme::{BLUE, MUTED, ORANGE, RED};
use crate::study::StudyRecord;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// The plot, `size` pixels.
pub(super) fn svg(record: &StudyRecord, size: (u32, u32)) -> Result<String, ReportError> {
    sheet("the convergence", size, |area| draw(area, record))
}

/// Best value after each evaluation, from the first value on: `(evaluations, mm)`.
pub(super) fn best_so_far(record: &StudyRecord) -> Vec<(f64, f64)> {
    let mut best: Option<f64> = None;
    let mut steps = Vec::new();
    for (n, recorded) in record.evaluations.iter().enumerate() {
        best = [best, recorded.value].into_iter().flatten().reduce(f64::max);
        steps.extend(best.map(|value| ((n + 1) as f64, value)));
    }
    steps
}

fn draw(area: &Area<'_>, record: &StudyRecord) -> Drawn {
    let count = record.evaluations.len();
    let values = || record.evaluations.iter().filter_map(|r| r.value);
    let mut range = around(values().chain([0.0]), 0.12);
    range.start = range.start.max(-0.02 * range.end);
    let bottom = range.start;
    let x = AxisOf { label: "evaluations", range: 0.0..(count.max(1) as f64 * 1.02 + 0.5) };
    let label = format!("{} (mm)", record.config.objective);
    let mut chart = axes(area, "", x, AxisOf { label: &label, range })?;
    if count == 0 {
        let style = words(17, MUTED, HPos::Center, VPos::Center);
        let note = Text::new("no evaluations yet", (0.75, 0.5), style);
        return chart.draw_series([note]).map(|_| ()).map_err(message);
    }
    let numbered = || record.evaluations.iter().enumerate().map(|(n, r)| ((n + 1) as f64, r.value));
    let points = numbered()
        .filter_map(|(n, value)| Some(Circle::new((n, value?), 3, BLUE.rgb().mix(0.55).filled())));
    chart
        .draw_series(points)
        .map_err(message)?
        .label("each evaluation")
        .legend(|(x, y)| Circle::new((x + 10, y), 4, BLUE.rgb().mix(0.55).filled()));
    let lost: Vec<f64> = numbered().filter(|(_, value)| value.is_none()).map(|(n, _)| n).collect();
    if !lost.is_empty() {
        let crosses = lost.iter().map(|&n| Cross::new((n, bottom.max(0.0)), 4, RED.rgb()));
        chart
            .draw_series(crosses)
            .map_err(message)?
            .label("no value (diverged)")
            .legend(|(x, y)| Cross::new((x + 10, y), 4, RED.rgb()));
    }
    let mut stairs: Vec<(f64, f64)> = Vec::new();
    for (n, value) in best_so_far(record) {
        if let Some(&(_, before)) = stairs.last() {
            stairs.push((n, before));
        }
        stairs.push((n, value));
    }
    if !stairs.is_empty() {
        chart
            .draw_series(LineSeries::new(stairs, ORANGE.rgb().stroke_width(3)))
            .map_err(message)?
            .label("best so far")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], ORANGE.rgb().stroke_width(3)));
    }
    legend(&mut chart, SeriesLabelPosition::LowerRight)
}
