//! Range against compliance stiffness: direction as colour, density as size.

use super::super::ReportError;
use super::super::chart::{Area, AxisOf, Drawn, around, axes, message, sheet, words};
use super::super::theme::MUTED;
use super::{Entry, HEAD, KEY, Mark, SERIES, distinct, headed, key, top};
use crate::input::stiffness::Measurement;
use crate::units::N_PER_MM;
use crate::verify::compare::published::{RangeSource, TaskTable};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::slice;

/// Three panels: ours, published simulation, bench experiments.
pub(super) fn svg(table: &TaskTable) -> Result<String, ReportError> {
    sheet("range against stiffness", (1240, 420 + HEAD + KEY), |area| {
        let title = format!("{}: tolerable range of the measured fingers", table.task);
        let note = "colour: infill direction · size: infill density · same axes in all panels";
        let body = headed(area, &title, note)?;
        let (panels, strip) = body.split_vertically(420);
        let sources = [RangeSource::Ours, RangeSource::Simulation, RangeSource::Bench];
        for (panel, source) in panels.split_evenly((1, 3)).iter().zip(sources) {
            draw(panel, table, source)?;
        }
        draw_key(&strip, table)
    })
}

fn draw(area: &Area<'_>, table: &TaskTable, source: RangeSource) -> Drawn {
    let stiffness = |m: &Measurement| m.compliance / N_PER_MM;
    let x = around(table.rows.iter().map(|row| stiffness(&row.design)), 0.14);
    let y = 0.0..top(slice::from_ref(table));
    let corner = (x.end - 0.03 * (x.end - x.start), 0.05 * y.end);
    let mut chart = axes(
        area,
        source.label(),
        AxisOf { label: "compliance stiffness (N/mm)", range: x },
        AxisOf { label: "tolerable range (mm)", range: y },
    )?;
    let directions = directions(table);
    let mut points: Vec<(Measurement, f64)> =
        table.rows.iter().filter_map(|row| Some((row.design, row.range_mm(source)?))).collect();
    // The largest first, or they would hide the small ones.
    points.sort_by(|a, b| b.0.density_percent.total_cmp(&a.0.density_percent));
    for (design, range) in &points {
        let colour = colour(&directions, design.direction_deg).rgb();
        let (at, size) = ((stiffness(design), *range), radius(design.density_percent));
        chart.draw_series([Circle::new(at, size, colour.mix(0.7).filled())]).map_err(message)?;
        chart.draw_series([Circle::new(at, size, colour.stroke_width(1))]).map_err(message)?;
    }
    if points.len() < table.rows.len() {
        let note = format!("{} of {} designs have a range", points.len(), table.rows.len());
        let style = words(14, MUTED, HPos::Right, VPos::Center);
        chart.draw_series([Text::new(note, corner, style)]).map_err(message)?;
    }
    Ok(())
}

fn directions(table: &TaskTable) -> Vec<f64> {
    distinct(table.rows.iter().map(|row| row.design.direction_deg))
}

fn colour(directions: &[f64], direction: f64) -> super::Colour {
    let found = directions.iter().position(|&d| d == direction).unwrap_or(0);
    SERIES[found % SERIES.len()]
}

/// Radius of a marker, pixels: area roughly as density.
fn radius(density_percent: f64) -> i32 {
    (2.2 * density_percent.max(1.0).sqrt()).round() as i32
}

fn draw_key(area: &Area<'_>, table: &TaskTable) -> Drawn {
    let directions = directions(table);
    let densities = distinct(table.rows.iter().map(|row| row.design.density_percent));
    // The quantity is named once, at the first of its values.
    let named = |i: usize, quantity: &str, value: String| match i {
        0 => format!("{quantity} {value}"),
        _ => value,
    };
    let mut names: Vec<(Mark, String)> = Vec::new();
    for (i, &direction) in directions.iter().enumerate() {
        let mark = Mark::Disc(colour(&directions, direction), radius(15.0));
        names.push((mark, named(i, "infill direction", format!("{direction}°"))));
    }
    for (i, &density) in densities.iter().enumerate() {
        let mark = Mark::Disc(MUTED, radius(density));
        names.push((mark, named(i, "infill density", format!("{density} %"))));
    }
    let entries: Vec<Entry<'_>> =
        names.iter().map(|(mark, name)| Entry { mark: *mark, name }).collect();
    key(area, 16, &entries)
}
