//! Simulated against bench range, ours and the published simulation's.

use super::super::ReportError;
use super::super::chart::{Area, AxisOf, Drawn, axes, message, sheet, words};
use super::super::theme::{INK, MUTED};
use super::{HEAD, Mark, SERIES, headed, top};
use crate::verify::compare::published::{Agreement, RangeSource, TaskTable};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Height of a line of the key, pixels.
const LINE: u32 = 24;

/// Two panels with equal axes; a point on the diagonal agrees with the robot.
pub(super) fn svg(tables: &[TaskTable]) -> Result<String, ReportError> {
    let height = 540 + HEAD + LINE * tables.len() as u32 + 16;
    sheet("simulated against bench experiments", (1120, height), |area| {
        let title = "Simulated range against the range on the robot";
        let note = "one mark per design that was measured on the robot · dashed: equal ranges";
        let body = headed(area, title, note)?;
        let (panels, strip) = body.split_vertically(540);
        let sources = [RangeSource::Ours, RangeSource::Simulation];
        let (panels, keys) = (panels.split_evenly((1, 2)), strip.split_evenly((1, 2)));
        for ((panel, key), source) in panels.iter().zip(&keys).zip(sources) {
            draw(panel, tables, source)?;
            draw_key(key, tables, source)?;
        }
        Ok(())
    })
}

fn marks() -> impl Iterator<Item = Mark> {
    SERIES.into_iter().cycle().map(|colour| Mark::Disc(colour, 6))
}

fn draw(area: &Area<'_>, tables: &[TaskTable], source: RangeSource) -> Drawn {
    let end = top(tables);
    let mut chart = axes(
        area,
        source.label(),
        AxisOf { label: "range in the bench experiments (mm)", range: 0.0..end },
        AxisOf { label: "simulated range (mm)", range: 0.0..end },
    )?;
    let diagonal = [(0.0, 0.0), (end, end)];
    let line = DashedLineSeries::new(diagonal, 6, 5, MUTED.rgb().stroke_width(1));
    chart.draw_series(line).map_err(message)?;
    for (table, mark) in tables.iter().zip(marks()) {
        let colour = mark.colour().rgb();
        let points = table.rows.iter().filter_map(|row| {
            let at = (row.range_mm(RangeSource::Bench)?, row.range_mm(source)?);
            Some(Circle::new(at, 6, colour.mix(0.65).filled()))
        });
        chart.draw_series(points).map_err(message)?;
    }
    Ok(())
}

/// The tasks' marks, and how well a panel's source agrees with the robot.
fn draw_key(area: &Area<'_>, tables: &[TaskTable], source: RangeSource) -> Drawn {
    let style = words(15, INK, HPos::Left, VPos::Center);
    for (i, (table, mark)) in tables.iter().zip(marks()).enumerate() {
        let found = Agreement::of(&table.rows, source, RangeSource::Bench);
        let value =
            |value: Option<f64>, text: &dyn Fn(f64) -> String| value.map_or("–".to_owned(), text);
        let error = value(found.mean_absolute_error_mm, &|e| format!("{e:.1} mm"));
        let deviation = value(found.mean_deviation_percent, &|d| format!("{d:.0} %"));
        let rank = value(found.spearman, &|r| format!("{r:+.2}"));
        let y = LINE as i32 / 2 + LINE as i32 * i as i32;
        let note = format!("mean error {error} ({deviation}), rank correlation {rank}");
        mark.draw(area, (78, y))?;
        area.draw_text(&table.task, &style, (94, y)).map_err(message)?;
        area.draw_text(&note, &style, (150, y)).map_err(message)?;
    }
    Ok(())
}
