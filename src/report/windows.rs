//! Tolerance windows of the best designs, as bars about the nominal start.

use super::ReportError;
use super::chart::{Area, AxisOf, Drawn, message, sheet, tick, words};
use super::text;
use super::theme::{BLUE, INK, LINES, MUTED, RED};
use crate::evaluation::Outcome;
use crate::study::{Recorded, StudyRecord};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// How many designs are shown.
pub(super) const SHOWN: usize = 10;

/// The best evaluations, best first; equals in the order they were measured.
pub(super) fn best(record: &StudyRecord) -> Vec<(&Recorded, f64)> {
    let mut with_value: Vec<(&Recorded, f64)> =
        record.evaluations.iter().filter_map(|r| Some((r, r.value?))).collect();
    with_value.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.index.cmp(&b.0.index)));
    with_value.truncate(SHOWN);
    with_value
}

/// The bars, as wide as `width` pixels; `None` if no evaluation has a value.
pub(super) fn svg(record: &StudyRecord, width: u32) -> Result<Option<String>, ReportError> {
    let shown = best(record);
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

fn draw(area: &Area<'_>, shown: &[(&Recorded, f64)]) -> Drawn {
    let window = |r: &Recorded| r.evaluation.window.clone();
    let low = shown.iter().map(|(r, _)| window(r).negative_mm()).fold(0.0, f64::min);
    let high = shown.iter().map(|(r, _)| window(r).positive_mm()).fold(0.0, f64::max);
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
    for (row, (recorded, value)) in shown.iter().enumerate() {
        let (row, window) = (row as f64, window(recorded));
        let title = format!("{}.  {}   {value:.1} mm", row + 1.0, name(recorded));
        let middle = (low + high) / 2.0;
        labels.push(text(title, (middle, row + 0.24), words(15, INK, HPos::Center, VPos::Center)));
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
