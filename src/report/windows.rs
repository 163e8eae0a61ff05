//! Tolerance windows of the best designs, as bars about the nominal start.

use super::ReportError;
use super::chart::{Area, Drawn, message, sheet, tick, words};
use super::elements::{figure, table};
use super::text;
use super::theme::{BLUE, INK, LINES, MUTED, RED};
use crate::evaluation::Window;
use crate::outcome::{FailureClass, Outcome};
use crate::study::{Recorded, StudyRecord};
use maud::{Markup, html};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// How many designs are shown.
const SHOWN: usize = 10;

/// The best evaluations that keep all constraints, best first; equals in the order they were
/// measured. Of several objectives those on the front.
fn best(record: &StudyRecord) -> Vec<(&Recorded, &[f64])> {
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

/// A window of the plot, with what stands above it.
struct Bar<'a> {
    title: String,
    window: &'a Window,
}

/// The windows on one task, by its place among the tasks: bars as wide as `width` pixels, and
/// the same as a table for those who cannot see them.
pub(super) fn section(
    record: &StudyRecord,
    task: usize,
    width: u32,
) -> Result<Markup, ReportError> {
    let best = best(record);
    let chosen = record.recommended().map(|best| best.index);
    let bars: Vec<Bar<'_>> = (1..)
        .zip(&best)
        .filter_map(|(place, (recorded, values))| {
            let value = text::values(&record.config.objective, values);
            let recommended = if chosen == Some(recorded.index) { ", recommended" } else { "" };
            let title = format!("{place}.  {}:  {value}{recommended}", name(recorded));
            Some(Bar { title, window: &recorded.on(task)?.window })
        })
        .collect();
    if bars.is_empty() {
        return Ok(html! { p { "No evaluation has a value and keeps all constraints." } });
    }
    let height = 64 + 44 * bars.len() as u32;
    let svg = sheet("the windows", (width, height), |area| draw(area, &bars))?;
    let classes = FailureClass::ALL.map(|class| format!("{}: {}", class.short(), class.label()));
    let caption = format!(
        "Offsets that insert, about the nominal start (stroke at 0 mm), on the 0.1 mm grid, by the \
         first search. At each end the failure met there ({}).",
        classes.join("; ")
    );
    Ok(html! {
        (figure(&svg, "tolerance windows of the best designs", &caption))
        details { summary { "The same as a table" } (as_table(record, &best, task)) }
    })
}

fn as_table(record: &StudyRecord, best: &[(&Recorded, &[f64])], task: usize) -> Markup {
    let row = |(r, found): &(&Recorded, &[f64])| {
        let window = &r.on(task)?.window;
        Some(vec![
            r.index.to_string(),
            text::design(&r.design),
            text::values(&record.config.objective, found),
            format!("{:+.1} to {:+.1} mm", window.negative_mm(), window.positive_mm()),
            text::stiffness(r.stiffness.compliance),
            if r.stiffness.inside_hull() { "inside" } else { "outside" }.to_owned(),
        ])
    };
    let head =
        ["evaluation", "design", "objective", "window", "compliance stiffness", "measured hull"];
    table(&head, &best.iter().filter_map(row).collect::<Vec<_>>())
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

fn draw(area: &Area<'_>, bars: &[Bar<'_>]) -> Drawn {
    let low = bars.iter().map(|bar| bar.window.negative_mm()).fold(0.0, f64::min);
    let high = bars.iter().map(|bar| bar.window.positive_mm()).fold(0.0, f64::max);
    // Room for the labels at both ends.
    let room = (0.32 * (high - low)).max(0.6);
    let rows = bars.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .x_label_area_size(46)
        .build_cartesian_2d(low - room..high + room, rows..0.0)
        .map_err(message)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .x_desc("offset of the start along y (mm)")
        .x_labels(7)
        .x_label_formatter(&|v| tick(*v))
        .axis_style(MUTED.rgb())
        .bold_line_style(LINES.rgb())
        .light_line_style(TRANSPARENT)
        .label_style(words(15, INK, HPos::Center, VPos::Top))
        .axis_desc_style(words(16, INK, HPos::Center, VPos::Top))
        .draw()
        .map_err(message)?;
    let gap = 0.02 * (high - low).max(1.0);
    let mut labels = Vec::new();
    for (n, Bar { title, window }) in bars.iter().enumerate() {
        let (top, y) = (n as f64 + 0.24, n as f64 + 0.68);
        let (left, right) = (window.negative_mm(), window.positive_mm());
        if window.nominal == Outcome::Inserted {
            let corners = [(left, y - 0.17), (right, y + 0.17)];
            let bar = Rectangle::new(corners, BLUE.rgb().mix(0.75).filled());
            chart.draw_series([bar]).map_err(message)?;
        }
        let above = words(15, INK, HPos::Center, VPos::Center);
        let nominal =
            PathElement::new([(0.0, y - 0.24), (0.0, y + 0.24)], INK.rgb().stroke_width(2));
        chart.draw_series([nominal]).map_err(message)?;
        labels.push(Text::new(title.clone(), ((low + high) / 2.0, top), above));
        let end = |end, x, side| {
            Text::new(text::end_short(end), (x, y), words(14, RED, side, VPos::Center))
        };
        labels.push(end(window.end_negative, left - gap, HPos::Right));
        labels.push(end(window.end_positive, right + gap, HPos::Left));
    }
    chart.draw_series(labels).map(|_| ()).map_err(message)
}
