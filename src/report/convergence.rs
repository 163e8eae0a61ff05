//! Best so far, and each value, against evaluations; of several objectives the hypervolume.

use super::ReportError;
use super::chart::{Area, AxisOf, Chart, Drawn, around, axes, legend, message, sheet, words};
use super::text::volume_unit;
use super::theme::{BLUE, MUTED, ORANGE, RED};
use crate::study::{Recorded, StudyRecord, volume};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// The plot, `size` pixels.
pub(super) fn svg(record: &StudyRecord, size: (u32, u32)) -> Result<String, ReportError> {
    sheet("the convergence", size, |area| draw(area, record))
}

/// Best value of a design that keeps all constraints after each evaluation, from the first
/// such value on; of several objectives the hypervolume: `(evaluations, value)`.
pub(super) fn best_so_far(record: &StudyRecord) -> Vec<(f64, f64)> {
    let goals = record.config.goals();
    let numbered = |index: usize| (index + 1) as f64;
    let Some(measure) = goals.objectives.single() else {
        let volume = volume(&goals, &record.evaluations);
        return volume.so_far.iter().enumerate().map(|(n, &v)| (numbered(n), v)).collect();
    };
    let mut best: Option<f64> = None;
    let mut steps = Vec::new();
    for (n, recorded) in record.evaluations.iter().enumerate() {
        let value = recorded.feasible().and_then(|values| values.first().copied());
        let better = |a: f64, b: f64| if measure.sense() * b > measure.sense() * a { b } else { a };
        best = [best, value].into_iter().flatten().reduce(better);
        steps.extend(best.map(|value| (numbered(n), value)));
    }
    steps
}

fn draw(area: &Area<'_>, record: &StudyRecord) -> Drawn {
    let count = record.evaluations.len();
    let objectives = &record.config.objective;
    let best = best_so_far(record);
    let all = record.evaluations.iter().filter_map(Recorded::value);
    // The values of one of several objectives have no place beside a volume.
    let values: Vec<f64> = if objectives.single().is_some() {
        all.collect()
    } else {
        best.iter().map(|b| b.1).collect()
    };
    let mut range = around(values.iter().copied().chain([0.0]), 0.12);
    if values.iter().all(|&value| value >= 0.0) {
        range.start = range.start.max(-0.02 * range.end);
    }
    let bottom = range.start;
    let x = AxisOf { label: "evaluations", range: 0.0..(count.max(1) as f64 * 1.02 + 0.5) };
    let label = match objectives.single() {
        Some(measure) => measure.label(),
        None => format!("hypervolume ({})", volume_unit(objectives)),
    };
    let mut chart = axes(area, "", x, AxisOf { label: &label, range })?;
    if count == 0 {
        let style = words(17, MUTED, HPos::Center, VPos::Center);
        let note = Text::new("no evaluations yet", (0.75, 0.5), style);
        return chart.draw_series([note]).map(|_| ()).map_err(message);
    }
    if objectives.single().is_some() {
        dots(&mut chart, record)?;
    }
    lost(&mut chart, record, bottom)?;
    let corner = match objectives.single() {
        Some(measure) if measure.sense() < 0.0 => SeriesLabelPosition::UpperRight,
        _ => SeriesLabelPosition::LowerRight,
    };
    let name = if objectives.single().is_some() { "best so far" } else { "hypervolume so far" };
    stairs(&mut chart, &best, name)?;
    legend(&mut chart, corner)
}

fn numbered(record: &StudyRecord) -> impl Iterator<Item = (f64, &Recorded)> {
    record.evaluations.iter().enumerate().map(|(n, recorded)| ((n + 1) as f64, recorded))
}

/// Each evaluation that has a value.
fn dots(chart: &mut Chart<'_, '_>, record: &StudyRecord) -> Drawn {
    let style = BLUE.rgb().mix(0.55).filled();
    let of = |feasible: bool| {
        numbered(record)
            .filter(move |(_, recorded)| recorded.feasible().is_some() == feasible)
            .filter_map(|(n, recorded)| Some((n, recorded.value()?)))
    };
    chart
        .draw_series(of(true).map(|point| Circle::new(point, 3, style)))
        .map_err(message)?
        .label("each evaluation")
        .legend(move |(x, y)| Circle::new((x + 10, y), 4, style));
    let outside: Vec<(f64, f64)> = of(false).collect();
    if !outside.is_empty() {
        let style = MUTED.rgb().stroke_width(1);
        chart
            .draw_series(outside.into_iter().map(|point| Circle::new(point, 3, style)))
            .map_err(message)?
            .label("violates a constraint")
            .legend(move |(x, y)| Circle::new((x + 10, y), 4, style));
    }
    Ok(())
}

/// Each evaluation that has none.
fn lost(chart: &mut Chart<'_, '_>, record: &StudyRecord, bottom: f64) -> Drawn {
    let lost: Vec<f64> =
        numbered(record).filter(|(_, recorded)| recorded.score.is_none()).map(|(n, _)| n).collect();
    if lost.is_empty() {
        return Ok(());
    }
    let crosses = lost.iter().map(|&n| Cross::new((n, bottom.max(0.0)), 4, RED.rgb()));
    chart
        .draw_series(crosses)
        .map_err(message)?
        .label("no value")
        .legend(|(x, y)| Cross::new((x + 10, y), 4, RED.rgb()));
    Ok(())
}

fn stairs(chart: &mut Chart<'_, '_>, best: &[(f64, f64)], name: &str) -> Drawn {
    let mut stairs: Vec<(f64, f64)> = Vec::new();
    for &(n, value) in best {
        if let Some(&(_, before)) = stairs.last() {
            stairs.push((n, before));
        }
        stairs.push((n, value));
    }
    if !stairs.is_empty() {
        chart
            .draw_series(LineSeries::new(stairs, ORANGE.rgb().stroke_width(3)))
            .map_err(message)?
            .label(name)
            .legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], ORANGE.rgb().stroke_width(3)));
    }
    Ok(())
}
