//! The plot of a comparison.

use super::ReportError;
use super::chart::{Area, Drawn, around, axes, legend, message, sheet};
use super::compare::{Comparison, OptimizerGroup, TOLERANCE_MM};
use super::marks::{line, stairs};
use super::theme::{BLUE, Colour, GREEN, INK, MUTED, ORANGE, RED};
use plotters::prelude::*;

const COLOURS: [Colour; 6] = [BLUE, ORANGE, GREEN, RED, MUTED, INK];

/// `compare.svg`: best so far of each optimizer, the median as a line and the quartiles as a band.
pub fn svg(comparison: &Comparison) -> Result<String, ReportError> {
    sheet("the comparison", (880, 480), |area| draw(area, comparison))
}

fn draw(area: &Area<'_>, comparison: &Comparison) -> Drawn {
    let groups = &comparison.groups;
    let longest = groups.iter().map(|g| g.best_so_far_mm.len()).max().unwrap_or(0).max(1) as f64;
    let values = groups.iter().flat_map(|g| g.best_so_far_mm.iter().flat_map(|q| q.all()));
    let range = around(values.flatten().chain([comparison.best_known_mm]), 0.06);
    let title = format!("{}: best so far, median and quartiles over seeds", comparison.task);
    let label = format!("{} (mm)", comparison.objective);
    let x = ("number of evaluations", 0.0..longest * 1.02 + 0.5);
    let mut chart = axes(area, &title, x, (&label, range))?;
    let coloured = || groups.iter().zip(COLOURS.iter().cycle());
    for (group, colour) in coloured().filter(|(group, _)| group.studies > 1) {
        let mut outline = quartile(group, 0);
        outline.extend(quartile(group, 2).into_iter().rev());
        if !outline.is_empty() {
            let band = Polygon::new(outline, colour.rgb().mix(0.16).filled());
            chart.draw_series([band]).map_err(message)?;
        }
    }
    let several =
        |g: &OptimizerGroup| groups.iter().filter(|o| o.optimizer == g.optimizer).count() > 1;
    for (group, colour) in coloured() {
        let batch = if several(group) { format!(", batch {}", group.batch) } else { String::new() };
        let plural = if group.studies == 1 { "study" } else { "studies" };
        let label = format!("{}{batch} ({} {plural})", group.optimizer, group.studies);
        line(&mut chart, quartile(group, 1), colour.rgb().stroke_width(3), label)?;
    }
    let target = vec![(0.0, comparison.target_mm), (longest, comparison.target_mm)];
    let label = format!("best known - {TOLERANCE_MM} mm");
    line(&mut chart, target, MUTED.rgb().stroke_width(1), label)?;
    legend(&mut chart, SeriesLabelPosition::LowerRight)
}

/// One of the quartiles as stairs, from the first evaluation on at which it is known.
fn quartile(group: &OptimizerGroup, which: usize) -> Vec<(f64, f64)> {
    let numbered = (1..).zip(&group.best_so_far_mm);
    stairs(numbered.filter_map(|(n, quartiles)| Some((f64::from(n), quartiles.all()[which]?))))
}
