//! Convergence plot: value and best value so far against the number of evaluations; with several objectives the
//! hypervolume.

use super::ReportError;
use super::chart::{Area, DrawResult, HPos, VPos, axes, padded_range, render, text_style};
use super::elements::figure;
use super::marks::{PointMark, Series, dashed, label, legend_above, line, points, stairs};
use super::selection::{PLOTTED, change_points, note, selected};
use super::theme::{BLUE, GREEN, MUTED, ORANGE, RED};
use crate::answer::words::{settled, volume_unit};
use insertion::Measure;
use maud::Markup;
use plotters::prelude::*;
use study::{Recorded, StudyRecord, Walked, volume};

/// Plots the value of each evaluation and the best so far (with several objectives the hypervolume) against the index
/// of the evaluation; `size` is width and height, pixels.
pub fn svg(record: &StudyRecord, size: (u32, u32)) -> Result<String, ReportError> {
    render("the convergence", size, |area| draw(area, record))
}

pub(super) fn section(record: &StudyRecord, size: (u32, u32)) -> Result<Markup, ReportError> {
    let caption = match record.config.objective.single() {
        Some(Measure::Range | Measure::CentredRange) => {
            "Value of each evaluation, and the best of the search so far. Values are multiples of 0.1 mm."
        }
        Some(_) => "Value of each evaluation, and the best of the search so far.",
        None => "Hypervolume of the front after each evaluation; its reference is given there.",
    };
    let settled = record.settled.then(|| format!(" Settled {}.", settled(record)));
    let note = note(record).map(|note| format!(" {note}"));
    let more = [settled, difference(record), note].into_iter().flatten();
    let caption = more.fold(caption.to_owned(), |caption, more| caption + &more);
    Ok(figure(&svg(record, size)?, "best value against evaluations", &caption))
}

/// Returns index of the evaluation and firm value of each walked design, the recommended one first.
fn confirmed(record: &StudyRecord) -> Vec<(f64, f64)> {
    let firm = |walked: &Walked| {
        let index = walked.recorded.index;
        Some((index as f64, *record.firm_values.get(&index)?))
    };
    record.walked.iter().filter_map(firm).collect()
}

/// Returns the difference between the best confirmed value and the best of the search, as sentences.
fn difference(record: &StudyRecord) -> Option<String> {
    let measure = record.config.objective.single()?;
    let [firm, searched] = [confirmed(record).first()?.1, best_so_far(record).last()?.1];
    let [firm, searched] = [firm, searched].map(|value| measure.show(value));
    Some(format!(
        " Confirmed: walked step by step and repeated; the best has {firm}. The line ends at \
         {searched}, the best of the search."
    ))
}

/// Returns index of the evaluation and best feasible value so far, from the first feasible evaluation on; with several
/// objectives the hypervolume.
pub(super) fn best_so_far(record: &StudyRecord) -> Vec<(f64, f64)> {
    let goals = record.config.goals();
    let Some(measure) = goals.objectives.single() else {
        let volume = volume(&goals, &record.evaluations);
        return volume.so_far.iter().enumerate().map(|(n, &v)| (n as f64, v)).collect();
    };
    let mut best: Option<f64> = None;
    let mut steps = Vec::new();
    for recorded in &record.evaluations {
        let value = recorded.known_value().filter(|_| recorded.feasible().is_some());
        let better = |a: f64, b: f64| if measure.sense() * b > measure.sense() * a { b } else { a };
        best = [best, value].into_iter().flatten().reduce(better);
        steps.extend(best.map(|value| (recorded.index as f64, value)));
    }
    steps
}

fn draw(area: &Area<'_>, record: &StudyRecord) -> DrawResult {
    let count = record.evaluations.len();
    let objectives = &record.config.objective;
    let best = best_so_far(record);
    let at = |r: &Recorded| Some((r.index as f64, r.value()?));
    // With several objectives only the hypervolume is plotted.
    let values: Vec<f64> = match objectives.single() {
        Some(_) => record.evaluations.iter().filter_map(Recorded::value).collect(),
        None => best.iter().map(|b| b.1).collect(),
    };
    let confirmed = confirmed(record);
    let shown = values.iter().chain(confirmed.iter().map(|(_, value)| value));
    let mut range = padded_range(shown.copied().chain([0.0]), 0.12);
    if values.iter().all(|&value| value >= 0.0) {
        range.start = range.start.max(-0.02 * range.end);
    }
    let (bottom, top) = (range.start.max(0.0), range.end);
    let last = count.max(2) as f64 - 1.0;
    let x = ("evaluation", -0.02 * last..1.02 * last);
    let (y_label, name) = match objectives.single() {
        Some(measure) => (measure.label(), "best of the search"),
        None => (format!("hypervolume ({})", volume_unit(objectives)), "hypervolume so far"),
    };
    if count == 0 {
        let mut chart = axes(area, "", x, (&y_label, range), None)?;
        let style = text_style(17, MUTED, HPos::Center, VPos::Center);
        return label(&mut chart, (0.5, 0.5), (0, 0), "no evaluations yet", &style);
    }
    let shown = selected(record, &record.evaluations, PLOTTED);
    let filtered = |which: &dyn Fn(&Recorded) -> bool| -> Vec<(f64, f64)> {
        shown.iter().copied().filter(|&found| which(found)).filter_map(at).collect()
    };
    let without_value = shown.iter().filter(|found| found.score.is_none());
    let mut series: Vec<Series<'_>> = vec![(
        without_value.map(|found| (found.index as f64, bottom)).collect(),
        PointMark::cross(RED, 4),
        "no value",
    )];
    if objectives.single().is_some() {
        let feasible = |found: &Recorded| found.feasible().is_some();
        let raced = filtered(&|found| found.raced());
        let each = filtered(&|found| !found.raced() && feasible(found));
        let violating = filtered(&|found| !found.raced() && !feasible(found));
        series.extend([
            (raced, PointMark::ring(BLUE, 3, 1), "at most (raced)"),
            (each, PointMark::dot(BLUE, 3), "each evaluation"),
            (violating, PointMark::ring(MUTED, 3, 1), "violates a constraint"),
            (confirmed, PointMark::disc(GREEN, 5), "confirmed"),
        ]);
    }
    series.retain(|(points, ..)| !points.is_empty());
    let best_line = ORANGE.rgb.stroke_width(3);
    let area = legend_above(area, &series, (best_line, name))?;
    let mut chart = axes(&area, "", x, (&y_label, range), None)?;
    if record.settled {
        dashed(&mut chart, [bottom, top].map(|value| (last, value)))?;
    }
    for (at, mark, _) in series {
        points(&mut chart, at, mark, "")?;
    }
    line(&mut chart, stairs(change_points(best)), best_line, "")
}
