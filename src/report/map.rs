//! Map of the (first) objective over infill density and direction.

use super::ReportError;
use super::chart::{Area, AxisOf, Drawn, axes, message, sheet, words};
use super::drawn::drawn;
use super::elements::figure;
use super::marks::{PointMark, points};
use super::theme::{Colour, INK, LINES, MUTED, ORANGE, RED, SCALE};
use crate::evaluation::objective::Measure;
use crate::input::space::{DENSITY_KEY, DIRECTION_KEY, Parameter};
use crate::input::stiffness::Measurement;
use crate::study::{Recorded, StudyRecord};
use maud::{Markup, html};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// The map, `size` pixels, or that the space has no density and direction.
pub(super) fn section(
    record: &StudyRecord,
    measurements: &[Measurement],
    size: (u32, u32),
) -> Result<Markup, ReportError> {
    let parameters = record.config.space.parameters();
    let side = |key| parameters.iter().find(|parameter| parameter.key == key);
    let (Some(x), Some(y)) = (side(DENSITY_KEY), side(DIRECTION_KEY)) else {
        return Ok(html! { p { "The space of this study has no infill density and direction." } });
    };
    let svg = sheet("the map", size, |area| {
        let (plot, key) = area.split_vertically(size.1.saturating_sub(54));
        draw(&plot, [x, y], record, measurements)?;
        draw_key(&key, &Scale::of(record))
    })?;
    let caption = format!(
        "Coloured cells: evaluated designs, by {}. Rings: designs whose stiffness was measured. \
         Cross in a frame: the best design. Red outline: no value. Grey outline: violates a \
         constraint. Outside the rings' hull the stiffness is extrapolated. Of designs with the \
         same infill the best is on top.",
        record.config.objective.first()
    );
    Ok(figure(&svg, "map over infill density and direction", &caption))
}

/// Values and the colours between them.
struct Scale {
    measure: Measure,
    low: f64,
    high: f64,
}

impl Scale {
    fn of(record: &StudyRecord) -> Self {
        let measure = record.config.objective.first();
        let values = || record.evaluations.iter().filter_map(Recorded::value);
        let low = values().fold(f64::INFINITY, f64::min);
        let high = values().fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = match (low < high, high.is_finite()) {
            (true, _) => (low, high),
            // All alike, or none at all: a scale that ends with what there is.
            (false, true) => (high - 1.0, high.max(0.1)),
            (false, false) => (0.0, 1.0),
        };
        Scale { measure, low, high }
    }

    fn colour(&self, value: f64) -> Colour {
        let share = (value - self.low) / (self.high - self.low);
        SCALE[((share * SCALE.len() as f64) as usize).min(SCALE.len() - 1)]
    }
}

fn draw(
    area: &Area<'_>,
    [x, y]: [&Parameter; 2],
    record: &StudyRecord,
    measurements: &[Measurement],
) -> Drawn {
    let scale = Scale::of(record);
    let axis = |label, side: &Parameter| AxisOf {
        label,
        range: side.low - side.step..side.high + side.step,
    };
    let (density, direction) = (axis("infill density (%)", x), axis("infill direction (°)", y));
    let mut chart = axes(area, "", density, direction)?;
    // At least as large as can be seen, however fine the steps are.
    let half = |side: &Parameter| (side.step / 2.0).max((side.high - side.low) / 90.0);
    let (dx, dy) = (half(x), half(y));
    let cell = |density: f64, direction: f64, style: ShapeStyle| {
        Rectangle::new([(density - dx, direction - dy), (density + dx, direction + dy)], style)
    };
    // Best last: it stays visible where designs differ in more than the infill.
    let mut evaluations = drawn(record, &record.evaluations);
    let sense = scale.measure.sense();
    let merit = |r: &Recorded| r.value().map_or(f64::NEG_INFINITY, |value| sense * value);
    evaluations.sort_by(|a, b| merit(a).total_cmp(&merit(b)));
    for recorded in evaluations {
        let Some((density, direction)) = infill(recorded) else { continue };
        let style = match (recorded.value(), recorded.feasible()) {
            (Some(value), Some(_)) => scale.colour(value).rgb().filled(),
            (Some(_), None) => MUTED.rgb().stroke_width(1),
            (None, _) => RED.rgb().stroke_width(1),
        };
        chart.draw_series([cell(density, direction, style)]).map_err(message)?;
    }
    let measured = measurements.iter().map(|m| (m.density_percent, m.direction_deg));
    points(&mut chart, measured, PointMark::ring(ORANGE, 6, 2), "")?;
    let Some((density, direction)) = record.recommended().and_then(infill) else { return Ok(()) };
    let frame = cell(density, direction, INK.rgb().stroke_width(3));
    chart.draw_series([frame]).map_err(message)?;
    points(&mut chart, [(density, direction)], PointMark::cross(INK, 9), "")
}

fn infill(recorded: &Recorded) -> Option<(f64, f64)> {
    Some((recorded.design.get(DENSITY_KEY)?, recorded.design.get(DIRECTION_KEY)?))
}

/// The colour scale with its values, below the map.
fn draw_key(area: &Area<'_>, scale: &Scale) -> Drawn {
    let (width, _) = area.dim_in_pixel();
    let (left, right) = (72, width as i32 - 22);
    let at = |i: usize| left + (right - left) * i as i32 / SCALE.len() as i32;
    for (i, colour) in SCALE.iter().enumerate() {
        let corners = [(at(i), 4), (at(i + 1), 18)];
        area.draw(&Rectangle::new(corners, colour.rgb().filled())).map_err(message)?;
        area.draw(&Rectangle::new(corners, LINES.rgb())).map_err(message)?;
    }
    let style = |h| words(15, INK, h, VPos::Top);
    // Only a scale without a spread begins below what can be.
    let least = if scale.measure == Measure::RobustRange { f64::NEG_INFINITY } else { 0.0 };
    let low = scale.measure.show(scale.low.max(least));
    let high = scale.measure.show(scale.high);
    area.draw_text(&low, &style(HPos::Left), (left, 24)).map_err(message)?;
    area.draw_text(&high, &style(HPos::Right), (right, 24)).map_err(message)?;
    let middle = words(15, MUTED, HPos::Center, VPos::Top);
    area.draw_text(scale.measure.name(), &middle, ((left + right) / 2, 24)).map_err(message)
}
