//! Tolerance windows of the best designs, as bars about the nominal start.

use super::ReportError;
use super::chart::{Area, AxisOf, Drawn, message, sheet, tick, words};
use super::text;
use super::theme::{BLUE, INK, LINES, MUTED, RED};
use crate::evaluation::Window;
use crate::outcome::Outcome;
use crate::study::{Recorded, StudyRecord};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// How many designs are shown.
pub(super) const SHOWN: usize = 10;

/// The best evaluations that keep all constraints, best first; equals in the order they were
/// measured. Of several objectives those on the front.
pub(super) fn best(record: &StudyRecord) -> Vec<(&Recorded, &[f64])> {
    let goals = record.config.goals();
    let mut best: Vec<(&Recorded, &[f64])> = match goals.objectives.single() {
        Some(_) => record.evaluations.iter().filter_map(|r| Some((r, r.feasible()?))).collect(),
        None => record.front().into_iter().filter_map(|r| Some((r, r.feasible()?))).collect(),
    };
    // Stable, so that equals stay in their order.
    best.sort_by(|a, b| goals.order(b.1, a.1));
    best.truncate(SHOWN);
    best
}

/// A row of the plot.
struct Row<'a> {
    title: String,
    window: &'a Window,
}

/// The bars on one task, by its place among the tasks, as wide as `width` pixels; `None` if
/// no evaluation has a value.
pub(super) fn svg(
    record: &StudyRecord,
    task: usize,
    width: u32,
) -> Result<Option<String>, ReportError> {
    let shown: Vec<Row<'_>> = best(record)
        .into_iter()
        .zip(1..)
        .filter_map(|((recorded, values), place)| {
            let value = text::values(&record.config.objective, values);
            let title = format!("{place}.  {}   {value}", name(recorded));
            Some(Row { title, window: &recorded.on(task)?.window })
        })
        .collect();
    if shown.is_empty() {
        return Ok(None);
    }
    let height = 64 + 44 * shown.len() as u32;
    sheet("the windows", (width, height), |area| draw(area, &shown)).map(Some)
}

/// The design as far as there is room for it: with more than the infill, its evaluation.
fn name(recorded: &Recorded) -> String {
    let full = text::design(&recorded.design);
    let infill = text::infill(&recorded.design);
    if full == infill || infill.is_empty() {
        return full;
    }
    format!("{infill}, evaluation {}", recorded.index)
}

fn draw(area: &Area<'_>, shown: &[Row<'_>]) -> Drawn {
    let low = shown.iter().map(|row| row.window.negative_mm()).fold(0.0, f64::min);
    let high = shown.iter().map(|row| row.window.positive_mm()).fold(0.0, f64::max);
    // Room for the labels at both ends.
    let room = (0.32 * (high - low)).max(0.6);
    let x = AxisOf { label: "offset of the start along y (mm)", range: low - room..high + room };
    let rows = shown.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .x_label_area_size(46)
        .build_cartesian_2d(x.range, rows..0.0)
        .map_err(message)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .x_desc(x.label)
        .x_labels(7)
        .x_label_formatter(&|v| tick(*v))
        .axis_style(MUTED.rgb())
        .bold_line_style(LINES.rgb())
        .light_line_style(TRANSPARENT)
        .label_style(words(15, INK, HPos::Center, VPos::Top))
        .axis_desc_style(words(16, INK, HPos::Center, VPos::Top))
        .draw()
        .map_err(message)?;
    let text =
        |words_: String, at: (f64, f64), style: TextStyle<'static>| Text::new(words_, at, style);
    let mut labels = Vec::new();
    let mut bars = Vec::new();
    for (row, Row { title, window }) in shown.iter().enumerate() {
        let row = row as f64;
        let middle = (low + high) / 2.0;
        labels.push(text(
            title.clone(),
            (middle, row + 0.24),
            words(15, INK, HPos::Center, VPos::Center),
        ));
        let y = row + 0.68;
        let (mut left, mut right) = (window.end_negative, window.end_positive);
        if window.nominal != Outcome::Inserted {
            (left, right) = (Some(window.nominal), Some(window.nominal));
        } else {
            bars.push(Rectangle::new(
                [(window.negative_mm(), y - 0.17), (window.positive_mm(), y + 0.17)],
                BLUE.rgb().mix(0.75).filled(),
            ));
        }
        let gap = 0.02 * (high - low).max(1.0);
        let style = |h| words(14, RED, h, VPos::Center);
        let (from, to) = (window.negative_mm() - gap, window.positive_mm() + gap);
        labels.push(text(text::end_short(left).to_owned(), (from, y), style(HPos::Right)));
        labels.push(text(text::end_short(right).to_owned(), (to, y), style(HPos::Left)));
    }
    chart.draw_series(bars).map_err(message)?;
    let nominal = PathElement::new([(0.0, 0.0), (0.0, rows)], INK.rgb().stroke_width(1));
    chart.draw_series([nominal]).map_err(message)?;
    chart.draw_series(labels).map_err(message)?;
    Ok(())
}
