//! Pareto front of a study with several objectives.

use super::ReportError;
use super::chart::{Area, DrawResult, axes, legend, padded_range, render};
use super::elements::{figure, table};
use super::marks::{PointMark, line, points};
use super::selection::{PLOTTED, selected};
use super::theme::{BLUE, MUTED, ORANGE};
use crate::answer::words::{COMPLIANCE, design, stiffness, volume_unit};
use crate::answer::{Answer, Front};
use maud::{Markup, html};
use plotters::prelude::*;
use study::{Recorded, StudyRecord};

/// Plots the first two objectives of all evaluations, and the front; `size` is width and height, pixels. `None` if
/// there is only one objective or no evaluation has a value.
pub fn svg(record: &StudyRecord, size: (u32, u32)) -> Result<Option<String>, ReportError> {
    let several = record.config.objective.single().is_none();
    let any = record.evaluations.iter().any(|recorded| recorded.score.is_some());
    (several && any).then(|| render("the front", size, |area| draw(area, record))).transpose()
}

/// Returns plot, hypervolume and designs of the front; `None` for a single objective.
pub(super) fn section(answer: &Answer, size: (u32, u32)) -> Result<Option<Markup>, ReportError> {
    let Some(front) = &answer.front else { return Ok(None) };
    let caption = "All evaluated designs by their first two objectives. Rings: the Pareto front.";
    let svg = svg(answer.record, size)?;
    Ok(Some(html! {
        @if let Some(svg) = svg { (figure(&svg, "the front and all evaluations", caption)) }
        (designs(answer, front))
    }))
}

fn draw(area: &Area<'_>, record: &StudyRecord) -> DrawResult {
    let [first, second, ..] = record.config.objective.measures() else { return Ok(()) };
    let point = |r: &Recorded| match r.score.as_ref().map(|score| &score.values[..]) {
        Some([x, y, ..]) => Some((*x, *y)),
        _ => None,
    };
    let shown = selected(record, &record.evaluations, PLOTTED);
    let all = || shown.iter().filter_map(|&r| Some((r, point(r)?)));
    let [first, second] = [first, second].map(|measure| measure.label());
    let x = (first.as_str(), padded_range(all().map(|(_, p)| p.0), 0.08));
    let y = (second.as_str(), padded_range(all().map(|(_, p)| p.1), 0.16));
    let mut chart = axes(area, "", x, y, None)?;
    let of = |feasible| all().filter(move |(r, _)| r.feasible().is_some() == feasible);
    points(&mut chart, of(true).map(|(_, p)| p), PointMark::dot(BLUE, 3), "each evaluation")?;
    let ring = PointMark::ring(MUTED, 3, 1);
    points(&mut chart, of(false).map(|(_, p)| p), ring, "violates a constraint")?;
    let front: Vec<(f64, f64)> = record.front().into_iter().filter_map(point).collect();
    points(&mut chart, front.iter().copied(), PointMark::ring(ORANGE, 5, 2), "front")?;
    // With three objectives the projected front is not a line.
    if record.config.objective.measures().len() == 2 {
        line(&mut chart, front, ORANGE.rgb.stroke_width(2), "")?;
    }
    legend(&mut chart, SeriesLabelPosition::UpperLeft)
}

fn designs(answer: &Answer, Front { designs: front, volume: found }: &Front) -> Markup {
    let objectives = &answer.record.config.objective;
    if front.is_empty() {
        return html! {
            p.warn {
                "No design has values for all objectives and satisfies all constraints: there is no front."
            }
        };
    }
    let names = objectives.measures().iter().map(|measure| measure.name());
    let head: Vec<&str> =
        ["evaluation", "design"].into_iter().chain(names).chain([COMPLIANCE]).collect();
    let row = |recorded: &&Recorded| {
        let values = recorded.feasible().unwrap_or_default();
        let mut row = vec![recorded.index.to_string(), design(&recorded.design)];
        let shown = objectives.measures().iter().zip(values);
        row.extend(shown.map(|(measure, &value)| measure.show(value)));
        row.push(stiffness(recorded.stiffness.compliance));
        row
    };
    html! {
        p {
            (front.len()) " of " (answer.designs) " evaluated designs are on the front: \
            no other evaluated design dominates them. Their hypervolume is "
            (format!("{:.3}", found.hypervolume)) " " (volume_unit(objectives))
            " from the reference point " (objectives.show(&found.reference))
            " (0 for objectives to be maximized, the largest value of the study for others)."
        }
        (table(&head, front.iter().map(row)))
    }
}
