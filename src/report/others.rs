//! The (first) objective over each parameter beside the infill.

use super::ReportError;
use super::chart::{Area, AxisOf, Drawn, around, axes, message, sheet};
use super::text::is_infill;
use super::theme::{BLUE, INK};
use crate::evaluation::objective::Measure;
use crate::input::space::Parameter;
use crate::study::{Recorded, StudyRecord};
use plotters::prelude::*;

/// Pixels of one parameter's plot.
const HEIGHT: u32 = 220;

/// The plots, one below the other, as wide as `width` pixels; `None` if the space has
/// nothing beside the infill or nothing has a value.
pub(super) fn svg(record: &StudyRecord, width: u32) -> Result<Option<String>, ReportError> {
    let parameters = record.config.space.parameters();
    let others: Vec<&Parameter> = parameters.iter().filter(|p| !is_infill(&p.key)).collect();
    let Some(best) = record.best().filter(|_| !others.is_empty()) else { return Ok(None) };
    let size = (width, HEIGHT * others.len() as u32);
    let drawn = sheet("the other parameters", size, |area| {
        let areas = area.split_evenly((others.len(), 1));
        areas
            .iter()
            .zip(&others)
            .try_for_each(|(area, parameter)| draw(area, parameter, record, best))
    });
    drawn.map(Some)
}

fn draw(area: &Area<'_>, of: &Parameter, record: &StudyRecord, best: &Recorded) -> Drawn {
    let measure = record.config.objective.first();
    let point = |r: &Recorded| Some((r.design.get(&of.key)?, r.value()?));
    let points: Vec<(f64, f64)> = record.evaluations.iter().filter_map(point).collect();
    let mut range = around(points.iter().map(|p| p.1).chain([0.0]), 0.1);
    if measure != Measure::RobustRange {
        range.start = 0.0;
    }
    let x = AxisOf { label: &of.key, range: of.low - of.step..of.high + of.step };
    let mut chart = axes(area, "", x, AxisOf { label: &measure.label(), range })?;
    let dots = points.iter().map(|&p| Circle::new(p, 3, BLUE.rgb().mix(0.6).filled()));
    chart.draw_series(dots).map_err(message)?;
    let cross = point(best).map(|p| Cross::new(p, 7, INK.rgb().stroke_width(2)));
    chart.draw_series(cross).map_err(message)?;
    Ok(())
}
