//! Range against infill direction, one panel per task.

use super::super::ReportError;
use super::super::chart::{Area, AxisOf, Drawn, around, axes, message, sheet};
use super::{Entry, HEAD, KEY, Mark, distinct, headed, key, top};
use crate::verify::compare::published::{DesignRow, RangeSource, TaskTable};
use plotters::prelude::*;
use std::slice;

/// The sources, and how far their marks stand aside so that none hides another, degrees.
const SOURCES: [(RangeSource, f64); 3] =
    [(RangeSource::Ours, -0.9), (RangeSource::Simulation, 0.0), (RangeSource::Bench, 0.9)];

/// At most two panels in a row.
pub(super) fn svg(tables: &[TaskTable]) -> Result<String, ReportError> {
    let columns = tables.len().clamp(1, 2);
    let rows = tables.len().div_ceil(2).max(1);
    let (width, height) = (600 * columns as u32, 380 * rows as u32);
    sheet("range against direction", (width.max(760), height + HEAD + KEY), |area| {
        let title = "Tolerable range against infill direction";
        let note = "one mark per design, set aside by up to 1° · lines: mean of each direction";
        let body = headed(area, title, note)?;
        let (panels, strip) = body.split_vertically(height);
        for (panel, table) in panels.split_evenly((rows, columns)).iter().zip(tables) {
            draw(panel, table)?;
        }
        let entries =
            SOURCES.map(|(source, _)| Entry { mark: Mark::of(source), name: source.label() });
        key(&strip, 60, &entries)
    })
}

fn draw(area: &Area<'_>, table: &TaskTable) -> Drawn {
    let mut chart = axes(
        area,
        &table.task,
        AxisOf {
            label: "infill direction (°)",
            range: around(table.rows.iter().map(|row| row.design.direction_deg), 0.1),
        },
        AxisOf { label: "tolerable range (mm)", range: 0.0..top(slice::from_ref(table)) },
    )?;
    for (source, aside) in SOURCES {
        let mark = Mark::of(source);
        let line = LineSeries::new(means(&table.rows, source), mark.colour().rgb().mix(0.6));
        chart.draw_series(line).map_err(message)?;
        let (left, top) = area.get_base_pixel();
        for row in &table.rows {
            let Some(range) = row.range_mm(source) else { continue };
            let (x, y) = chart.backend_coord(&(row.design.direction_deg + aside, range));
            mark.draw(area, (x - left, y - top))?;
        }
    }
    Ok(())
}

/// The mean range of each direction that has one.
fn means(rows: &[DesignRow], source: RangeSource) -> Vec<(f64, f64)> {
    let mean = |direction: f64| {
        let here = rows.iter().filter(|row| row.design.direction_deg == direction);
        let ranges: Vec<f64> = here.filter_map(|row| row.range_mm(source)).collect();
        let mean = ranges.iter().sum::<f64>() / ranges.len() as f64;
        (!ranges.is_empty()).then_some((direction, mean))
    };
    distinct(rows.iter().map(|row| row.design.direction_deg)).into_iter().filter_map(mean).collect()
}
