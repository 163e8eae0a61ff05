//! Designs between which several objectives leave the choice.

use super::ReportError;
use super::chart::{Area, AxisOf, Drawn, around, axes, legend, message, sheet};
use super::sections::table;
use super::text::{design, escape, stiffness, volume_unit};
use super::theme::{BLUE, MUTED, ORANGE};
use crate::study::{Recorded, StudyRecord, volume};
use plotters::prelude::*;

/// The first objective against the second, all evaluations, `size` pixels; `None` if there is
/// one objective only or nothing has values.
pub(super) fn svg(record: &StudyRecord, size: (u32, u32)) -> Result<Option<String>, ReportError> {
    let several = record.config.objective.measures().len() > 1;
    let any = record.evaluations.iter().any(|recorded| recorded.score.is_some());
    if !several || !any {
        return Ok(None);
    }
    sheet("the front", size, |area| draw(area, record)).map(Some)
}

fn draw(area: &Area<'_>, record: &StudyRecord) -> Drawn {
    let [first, second, ..] = record.config.objective.measures() else { return Ok(()) };
    let point = |r: &Recorded| match r.score.as_ref().map(|score| &score.values[..]) {
        Some([x, y, ..]) => Some((*x, *y)),
        _ => None,
    };
    let all = || record.evaluations.iter().filter_map(|r| Some((r, point(r)?)));
    let x = AxisOf { label: &first.label(), range: around(all().map(|(_, p)| p.0), 0.08) };
    let y = AxisOf { label: &second.label(), range: around(all().map(|(_, p)| p.1), 0.16) };
    let mut chart = axes(area, "", x, y)?;
    let dot = BLUE.rgb().mix(0.5).filled();
    let feasible = all().filter(|(r, _)| r.feasible().is_some());
    chart
        .draw_series(feasible.map(|(_, p)| Circle::new(p, 3, dot)))
        .map_err(message)?
        .label("each evaluation")
        .legend(move |(x, y)| Circle::new((x + 10, y), 4, dot));
    let ring = MUTED.rgb().stroke_width(1);
    let outside: Vec<_> = all().filter(|(r, _)| r.feasible().is_none()).collect();
    if !outside.is_empty() {
        chart
            .draw_series(outside.into_iter().map(|(_, p)| Circle::new(p, 3, ring)))
            .map_err(message)?
            .label("violates a constraint")
            .legend(move |(x, y)| Circle::new((x + 10, y), 4, ring));
    }
    let front: Vec<(f64, f64)> = record.front().into_iter().filter_map(point).collect();
    let style = ORANGE.rgb().stroke_width(2);
    // Of three objectives the front is no line in the plane of two.
    if record.config.objective.measures().len() == 2 {
        chart.draw_series(LineSeries::new(front.clone(), style)).map_err(message)?;
    }
    chart
        .draw_series(front.into_iter().map(|p| Circle::new(p, 5, style)))
        .map_err(message)?
        .label("front")
        .legend(move |(x, y)| Circle::new((x + 10, y), 5, style));
    legend(&mut chart, SeriesLabelPosition::UpperLeft)
}

/// Hypervolume and designs of the front.
pub(super) fn section(record: &StudyRecord) -> String {
    let (front, goals) = (record.front(), record.config.goals());
    let objectives = &goals.objectives;
    if front.is_empty() {
        return "<p class=\"warn\">No design has values for all objectives and keeps all \
                constraints: there is no front.</p>\n"
            .to_owned();
    }
    let found = volume(&goals, &record.evaluations);
    let mut head = vec!["evaluation".to_owned(), "design".to_owned()];
    head.extend(objectives.measures().iter().map(|measure| measure.name().to_owned()));
    head.push("compliance stiffness".to_owned());
    let row = |recorded: &&Recorded| {
        let values = recorded.feasible().unwrap_or_default();
        let mut row = vec![recorded.index.to_string(), design(&recorded.design)];
        let shown = objectives.measures().iter().zip(values);
        row.extend(shown.map(|(measure, &value)| measure.show(value)));
        row.push(stiffness(recorded.stiffness.compliance));
        row
    };
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    format!(
        "<p>{} of {} evaluated designs are on the front: no other design that was evaluated \
         is at least as good in every objective and better in one. They dominate a hypervolume \
         of {:.3} {}, taken from the reference {} (0 for what is to be large, the largest value \
         of the study for what is to be small).</p>\n{}",
        front.len(),
        record.evaluations.len(),
        found.hypervolume,
        escape(&volume_unit(objectives)),
        escape(&objectives.show(&found.reference)),
        table(&head, &front.iter().map(row).collect::<Vec<_>>())
    )
}
