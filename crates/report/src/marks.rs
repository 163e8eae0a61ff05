//! Elements drawn in plots: marked points, lines, stairs.

use super::chart::{Area, Chart, DrawResult, HPos, PlotError, VPos, text_style};
use super::theme::{Colour, INK, MUTED};
use plotters::prelude::*;

/// Mark of a point: shape (circle or cross), size in pixels, and style.
#[derive(Clone, Copy)]
pub(super) struct PointMark {
    cross: bool,
    size: i32,
    style: ShapeStyle,
}

impl PointMark {
    /// Returns a translucent disc.
    pub fn dot(colour: Colour, size: i32) -> Self {
        PointMark { cross: false, size, style: colour.rgb.mix(0.55).filled() }
    }

    /// Returns an opaque disc.
    pub fn disc(colour: Colour, size: i32) -> Self {
        PointMark { cross: false, size, style: colour.rgb.filled() }
    }

    pub fn ring(colour: Colour, size: i32, width: u32) -> Self {
        PointMark { cross: false, size, style: colour.rgb.stroke_width(width) }
    }

    pub fn cross(colour: Colour, size: i32) -> Self {
        PointMark { cross: true, size, style: colour.rgb.stroke_width(2) }
    }

    fn at<'a, C: Clone + 'static>(self, at: C) -> DynElement<'static, SVGBackend<'a>, C> {
        match self.cross {
            true => Cross::new(at, self.size, self.style).into_dyn(),
            false => Circle::new(at, self.size, self.style).into_dyn(),
        }
    }
}

/// Series of points with its mark and its name in the legend.
pub(super) type Series<'a> = (Vec<(f64, f64)>, PointMark, &'a str);

/// Height of a line of a legend, width of a mark and of a letter, pixels.
const LEGEND: [i32; 3] = [22, 26, 8];
/// Margin of a legend on either side and at the top, pixels.
const MARGIN: i32 = 16;

/// Draws a legend of series and of a line in the upper part of an area; returns the part below.
pub(super) fn legend_above<'b>(
    area: &Area<'b>,
    series: &[Series<'_>],
    (style, line): (ShapeStyle, &str),
) -> Result<Area<'b>, PlotError> {
    let [height, mark, letter] = LEGEND;
    let names = series.iter().map(|(_, mark, name)| (Some(mark), *name)).chain([(None, line)]);
    let (right, [mut x, mut y]) = (area.dim_in_pixel().0 as i32 - MARGIN, [MARGIN, height]);
    let text = text_style(15, INK, HPos::Left, VPos::Center);
    for (of, name) in names {
        let width = mark + letter * name.len() as i32;
        if x > MARGIN && x + width > right {
            [x, y] = [MARGIN, y + height];
        }
        let drawn = match of {
            Some(of) => area.draw(&of.at((x + 12, y))),
            None => area.draw(&PathElement::new([(x, y), (x + 20, y)], style)),
        };
        drawn?;
        area.draw(&Text::new(name.to_owned(), (x + mark, y), text.clone()))?;
        x += width;
    }
    Ok(area.split_vertically(y + height / 2).1)
}

/// Draws marked points; `label` is for the legend, empty for none.
pub(super) fn points<'a, 'b: 'a>(
    chart: &mut Chart<'a, 'b>,
    points: impl IntoIterator<Item = (f64, f64)>,
    mark: PointMark,
    label: &str,
) -> DrawResult {
    let mut elements = points.into_iter().map(|at| mark.at(at)).peekable();
    if elements.peek().is_none() {
        return Ok(());
    }
    let series = chart.draw_series(elements)?;
    if !label.is_empty() {
        series.label(label).legend(move |(x, y)| mark.at((x + 10, y)));
    }
    Ok(())
}

/// Draws a line through points; `label` is for the legend, empty for none.
pub(super) fn line(
    chart: &mut Chart<'_, '_>,
    points: Vec<(f64, f64)>,
    style: ShapeStyle,
    label: impl Into<String>,
) -> DrawResult {
    if points.is_empty() {
        return Ok(());
    }
    let (series, label) = (chart.draw_series(LineSeries::new(points, style))?, label.into());
    if !label.is_empty() {
        series.label(label).legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], style));
    }
    Ok(())
}

/// Draws a dashed line between two points.
pub(super) fn dashed(chart: &mut Chart<'_, '_>, ends: [(f64, f64); 2]) -> DrawResult {
    chart.draw_series(DashedLineSeries::new(ends, 5, 4, MUTED.rgb.stroke_width(1)))?;
    Ok(())
}

/// Draws a bar between two values of x and two of y.
pub(super) fn bar(
    chart: &mut Chart<'_, '_>,
    x: [f64; 2],
    y: [f64; 2],
    style: impl Into<ShapeStyle>,
) -> DrawResult {
    chart.draw_series([Rectangle::new([(x[0], y[0]), (x[1], y[1])], style)])?;
    Ok(())
}

/// Writes a text at a point, shifted by `by`, pixels.
pub(super) fn label(
    chart: &mut Chart<'_, '_>,
    at: (f64, f64),
    by: (i32, i32),
    words: &str,
    style: &TextStyle<'static>,
) -> DrawResult {
    chart.draw_series([EmptyElement::at(at) + Text::new(words.to_owned(), by, style)])?;
    Ok(())
}

/// Returns the corners of a step function through points.
pub(super) fn stairs(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut stairs: Vec<(f64, f64)> = Vec::new();
    for (x, y) in points {
        stairs.extend(stairs.last().map(|&(_, before)| (x, before)));
        stairs.push((x, y));
    }
    stairs
}
