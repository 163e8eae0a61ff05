//! Common parts of all plots: size, axes, fonts.

use super::ReportError;
use super::theme::{Colour, INK, LINES, MUTED, PAPER};
use analysis::levers::thousandths;
use ask_tell::statistics::span;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::FontTransform;
use plotters::style::text_anchor::Pos;
pub(super) use plotters::style::text_anchor::{HPos, VPos};
use std::ops::Range;

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Chart<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
/// Error of the drawing library, or of the computation of a curve.
pub(super) type PlotError = Box<dyn std::error::Error>;
pub(super) type DrawResult = Result<(), PlotError>;

/// Draws on a blank canvas of `size`, pixels, and returns the SVG; `plot` is the name for error messages.
pub(super) fn render(
    plot: &'static str,
    size: (u32, u32),
    draw: impl FnOnce(&Area<'_>) -> DrawResult,
) -> Result<String, ReportError> {
    let mut svg = String::new();
    let canvas = |svg| -> DrawResult {
        let area = SVGBackend::with_string(svg, size).into_drawing_area();
        area.fill(&PAPER.rgb)?;
        draw(&area)?;
        Ok(area.present()?)
    };
    canvas(&mut svg).map_err(|problem| ReportError { plot, problem: problem.to_string() })?;
    Ok(svg)
}

/// Axis: label with unit, and range.
pub(super) type Axis<'a> = (&'a str, Range<f64>);

/// Draws an x axis with vertical grid lines for `count` rows; row i, from 0, extends from y = -i down to -(i + 1).
/// `left` is the width for the row names, pixels.
pub(super) fn rows<'a, 'b>(
    area: &'a Area<'b>,
    title: &str,
    x: Axis<'_>,
    count: usize,
    left: u32,
) -> Result<Chart<'a, 'b>, PlotError> {
    axes(area, title, x, ("", -(count.max(1) as f64)..0.0), Some(left))
}

/// Draws axes with a grid; `title` may be empty. With `names`, the width of the names of rows, pixels, instead of a y axis
/// and its part of the grid.
pub(super) fn axes<'a, 'b>(
    area: &'a Area<'b>,
    title: &str,
    x: Axis<'_>,
    y: Axis<'_>,
    names: Option<u32>,
) -> Result<Chart<'a, 'b>, PlotError> {
    let mut builder = ChartBuilder::on(area);
    builder.margin(10).margin_right(18).x_label_area_size(48);
    builder.y_label_area_size(names.unwrap_or(62));
    if !title.is_empty() {
        builder.caption(title, font(19).color(&INK.rgb));
    }
    let mut chart = builder.build_cartesian_2d(x.1, y.1)?;
    let mut mesh = chart.configure_mesh();
    if names.is_some() {
        mesh.disable_y_mesh().disable_y_axis();
    }
    mesh.x_desc(x.0)
        .y_desc(y.0)
        .x_labels(7)
        .y_labels(7)
        .x_label_formatter(&|v| thousandths(*v))
        .y_label_formatter(&|v| thousandths(*v))
        .axis_style(MUTED.rgb)
        .bold_line_style(LINES.rgb)
        .light_line_style(TRANSPARENT)
        .label_style(font(15).color(&INK.rgb))
        .axis_desc_style(font(16).color(&INK.rgb))
        .draw()?;
    Ok(chart)
}

/// Draws a legend of the labelled series in a corner.
pub(super) fn legend<'a, 'b: 'a>(
    chart: &mut Chart<'a, 'b>,
    corner: SeriesLabelPosition,
) -> DrawResult {
    let legend = chart
        .configure_series_labels()
        .position(corner)
        .margin(8)
        .legend_area_size(26)
        .label_font(font(15).color(&INK.rgb))
        .background_style(PAPER.rgb.mix(0.85))
        .border_style(LINES.rgb)
        .draw();
    Ok(legend?)
}

/// Returns the viewer's default sans-serif font in a size, pixels.
pub(super) fn font(size: u32) -> FontDesc<'static> {
    ("sans-serif", size).into_font().transform(FontTransform::None)
}

/// Returns a text style whose anchor is at `h` and `v` of the text.
pub(super) fn text_style(size: u32, colour: Colour, h: HPos, v: VPos) -> TextStyle<'static> {
    font(size).color(&colour.rgb).pos(Pos::new(h, v))
}

/// Returns the interval of the finite values, widened by a share `room` of it on either side; by 0.5 if they are equal,
/// 0 to 1 if there are none.
pub(super) fn padded_range(values: impl Iterator<Item = f64>, room: f64) -> Range<f64> {
    let [low, high] = span(values.filter(|v| v.is_finite()));
    if low > high {
        return 0.0..1.0;
    }
    let room = if high > low { (high - low) * room } else { 0.5 };
    low - room..high + room
}
