//! Calibrated ranges, each finger predicted without its own measurement, against the bench.

use super::super::ReportError;
use super::super::chart::{Area, AxisOf, Drawn, axes, message, sheet, words};
use super::super::theme::{Colour, INK, MUTED};
use super::{HEAD, Mark, SERIES, headed};
use crate::verify::compare::published::Calibrated;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Height of a line of the key, pixels.
const LINE: u32 = 24;

/// A point with an error bar for each finger; a point on the diagonal agrees with the robot.
///
/// # Errors
/// If the drawing library refuses.
pub fn calibrated_svg(tasks: &[Calibrated]) -> Result<String, ReportError> {
    let height = 560 + HEAD + LINE * tasks.len() as u32 + 16;
    sheet("calibrated against bench experiments", (720, height), |area| {
        let title = "Calibrated range against the range on the robot";
        let note = "each finger predicted without its own measurement · bars: 80 % · dashed: equal";
        let body = headed(area, title, note)?;
        let (panel, key) = body.split_vertically(560);
        draw(&panel, tasks)?;
        draw_key(&key, tasks)
    })
}

fn colours() -> impl Iterator<Item = Colour> {
    SERIES.into_iter().cycle()
}

fn draw(area: &Area<'_>, tasks: &[Calibrated]) -> Drawn {
    let fingers = || tasks.iter().flat_map(|task| &task.fingers);
    let top = fingers().map(|one| one.measured_mm.max(one.high_mm)).fold(1.0, f64::max);
    let end = (1.05 * top).ceil();
    let mut chart = axes(
        area,
        "",
        AxisOf { label: "range in the bench experiments (mm)", range: 0.0..end },
        AxisOf { label: "predicted range (mm)", range: 0.0..end },
    )?;
    let diagonal = [(0.0, 0.0), (end, end)];
    let line = DashedLineSeries::new(diagonal, 6, 5, MUTED.rgb().stroke_width(1));
    chart.draw_series(line).map_err(message)?;
    for (task, colour) in tasks.iter().zip(colours()) {
        let bars = task.fingers.iter().map(|one| {
            let ends = [(one.measured_mm, one.low_mm), (one.measured_mm, one.high_mm)];
            PathElement::new(ends, colour.rgb().stroke_width(2))
        });
        chart.draw_series(bars).map_err(message)?;
        let points = task.fingers.iter().map(|one| {
            Circle::new((one.measured_mm, one.range_mm), 5, colour.rgb().mix(0.65).filled())
        });
        chart.draw_series(points).map_err(message)?;
    }
    Ok(())
}

/// The tasks' marks, and how well each is predicted.
fn draw_key(area: &Area<'_>, tasks: &[Calibrated]) -> Drawn {
    let style = words(15, INK, HPos::Left, VPos::Center);
    for (i, (task, colour)) in tasks.iter().zip(colours()).enumerate() {
        let value =
            |value: Option<f64>, text: &dyn Fn(f64) -> String| value.map_or("–".to_owned(), text);
        let note = format!(
            "mean deviation {}, rank correlation {}, {} of {} inside",
            value(task.mean_deviation_percent(), &|d| format!("{d:.1} %")),
            value(task.spearman(), &|r| format!("{r:+.2}")),
            task.inside(),
            task.fingers.len()
        );
        let y = LINE as i32 / 2 + LINE as i32 * i as i32;
        Mark::Disc(colour, 5).draw(area, (78, y))?;
        area.draw_text(&task.task, &style, (94, y)).map_err(message)?;
        area.draw_text(&note, &style, (150, y)).map_err(message)?;
    }
    Ok(())
}
