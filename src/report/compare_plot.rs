//! The plot of a comparison.

use super::ReportError;
use super::chart::{Area, AxisOf, Chart, Drawn, around, axes, legend, message, sheet};
use super::compare::{Comparison, Group, TOLERANCE_MM};
use super::theme::{BLUE, Colour, GREEN, INK, MUTED, ORANGE, RED};
use plotters::prelude::*;

const COLOURS: [Colour; 6] = [BLUE, ORANGE, GREEN, RED, MUTED, INK];

/// `compare.svg`: best so far of each optimizer, the median as a line and the quartiles as a band.
///
/// # Errors
/// If the drawing library refuses.
pub fn svg(comparison: &Comparison) -> Result<String, ReportError> {
    sheet("the comparison", (880, 480), |area| draw(area, comparison))
}

fn draw(area: &Area<'_>, comparison: &Comparison) -> Drawn {
    let groups = &comparison.groups;
    let longest = groups.iter().map(|g| g.best_so_far.len()).max().unwrap_or(0).max(1) as f64;
    let values = groups.iter().flat_map(|g| g.best_so_far.iter().flatten().flatten().copied());
    let range = around(values.chain([comparison.best_known_mm]), 0.06);
    let title = format!("{}: best so far, median and quartiles over seeds", comparison.task);
    let label = format!("{} (mm)", comparison.objective);
    let x = AxisOf { label: "evaluations", range: 0.0..longest * 1.02 + 0.5 };
    let mut chart = axes(area, &title, x, AxisOf { label: &label, range })?;
    for (group, colour) in groups.iter().zip(COLOURS.iter().cycle()) {
        band(&mut chart, group, *colour)?;
    }
    let several = |g: &Group| groups.iter().filter(|o| o.optimizer == g.optimizer).count() > 1;
    for (group, colour) in groups.iter().zip(COLOURS.iter().cycle()) {
        let batch = if several(group) { format!(", batch {}", group.batch) } else { String::new() };
        let plural = if group.studies == 1 { "study" } else { "studies" };
        let label = format!("{}{batch} ({} {plural})", group.optimizer, group.studies);
        median(&mut chart, group, *colour, label)?;
    }
    let target = comparison.best_known_mm - TOLERANCE_MM;
    let line = DashedLineSeries::new(
        [(0.0, target), (longest, target)],
        5,
        4,
        MUTED.rgb().stroke_width(1),
    );
    chart
        .draw_series(line)
        .map_err(message)?
        .label(format!("best known - {TOLERANCE_MM} mm"))
        .legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], MUTED.rgb()));
    legend(&mut chart, SeriesLabelPosition::LowerRight)
}

/// One of the quartiles as stairs, from the first evaluation on at which it is known.
fn stairs(group: &Group, which: usize) -> Vec<(f64, f64)> {
    let mut stairs: Vec<(f64, f64)> = Vec::new();
    for (n, quartiles) in group.best_so_far.iter().enumerate() {
        let Some(value) = quartiles[which] else { continue };
        let n = (n + 1) as f64;
        stairs.extend(stairs.last().map(|&(_, before)| (n, before)));
        stairs.push((n, value));
    }
    stairs
}

fn band(chart: &mut Chart<'_, '_>, group: &Group, colour: Colour) -> Drawn {
    let mut outline = stairs(group, 0);
    outline.extend(stairs(group, 2).into_iter().rev());
    if group.studies < 2 || outline.is_empty() {
        return Ok(());
    }
    let polygon = Polygon::new(outline, colour.rgb().mix(0.16).filled());
    chart.draw_series([polygon]).map(|_| ()).map_err(message)
}

fn median<'a>(chart: &mut Chart<'a, '_>, group: &Group, colour: Colour, label: String) -> Drawn {
    let style = colour.rgb().stroke_width(3);
    chart
        .draw_series(LineSeries::new(stairs(group, 1), style))
        .map_err(message)?
        .label(label)
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], style));
    Ok(())
}
