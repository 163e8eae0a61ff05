//! The (first) objective over each parameter beside the infill.

use super::ReportError;
use super::chart::{Area, AxisOf, Drawn, around, axes, sheet};
use super::drawn::drawn;
use super::elements::figure;
use super::marks::{PointMark, points};
use super::text::is_infill;
use super::theme::{BLUE, INK};
use crate::evaluation::objective::Measure;
use crate::input::space::Parameter;
use crate::study::{Recorded, StudyRecord};
use maud::Markup;

/// Pixels of one parameter's plot.
const HEIGHT: u32 = 220;

/// The plots, one below the other, as wide as `width` pixels; `None` if the space has
/// nothing beside the infill or nothing has a value.
pub(super) fn section(record: &StudyRecord, width: u32) -> Result<Option<Markup>, ReportError> {
    let parameters = record.config.space.parameters();
    let others: Vec<&Parameter> = parameters.iter().filter(|p| !is_infill(&p.key)).collect();
    let Some(best) = record.recommended().filter(|_| !others.is_empty()) else { return Ok(None) };
    let size = (width, HEIGHT * others.len() as u32);
    let svg = sheet("the other parameters", size, |area| {
        let areas = area.split_evenly((others.len(), 1));
        let mut plots = areas.iter().zip(&others);
        plots.try_for_each(|(area, parameter)| draw(area, parameter, record, best))
    })?;
    let caption = "Each evaluated design against one number each of task and finger; all others \
                   differ as well. Cross: the best design.";
    Ok(Some(figure(&svg, "objective against the other parameters", caption)))
}

fn draw(area: &Area<'_>, of: &Parameter, record: &StudyRecord, best: &Recorded) -> Drawn {
    let measure = record.config.objective.first();
    let point = |r: &Recorded| Some((r.design.get(&of.key)?, r.value()?));
    let all: Vec<(f64, f64)> =
        drawn(record, &record.evaluations).into_iter().filter_map(point).collect();
    let mut range = around(all.iter().map(|p| p.1).chain([0.0]), 0.1);
    if measure != Measure::RobustRange {
        range.start = 0.0;
    }
    let x = AxisOf { label: &of.key, range: of.low - of.step..of.high + of.step };
    let mut chart = axes(area, "", x, AxisOf { label: &measure.label(), range })?;
    points(&mut chart, all, PointMark::dot(BLUE, 3), "")?;
    points(&mut chart, point(best), PointMark::cross(INK, 7), "")
}
