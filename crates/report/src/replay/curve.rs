//! Plot of force against depth of a trial.

use super::Film;
use crate::ReportError;
use crate::chart::{Area, DrawResult, axes, legend, padded_range, render};
use crate::marks::{PointMark, line, points};
use crate::theme::{BLUE, MUTED, RED};
use insertion::Outcome;
use plotters::prelude::{Color, SeriesLabelPosition};

/// Plots the contact force on the plug against the depth of its tip, from just before the first contact, as an SVG.
pub fn svg(film: &Film) -> Result<String, ReportError> {
    render("force against depth", (760, 480), |area| draw(area, film))
}

fn draw(area: &Area<'_>, film: &Film) -> DrawResult {
    let recording = film.recording;
    let touched = recording.frames.iter().find(|frame| frame.force.norm() > 0.01);
    let from = touched.map_or(0.0, |frame| frame.time_s - 0.02);
    let shown = recording.frames.iter().filter(|frame| frame.time_s >= from);
    let path: Vec<_> = shown.map(|frame| (frame.depth_mm(), frame.force.norm())).collect();
    let needed = film.task.success.depth / input::units::MM;
    let x = (
        "depth of the plug's tip below the socket's top (mm)",
        padded_range(path.iter().map(|p| p.0).chain([needed]), 0.06),
    );
    let mut force = padded_range(path.iter().map(|p| p.1).chain([0.0]), 0.1);
    force.start = 0.0;
    let top = force.end;
    let y = ("force plug to socket (N)", force);
    let title = format!("{}, {}: {}", film.task.name, film.label, recording.trial.outcome.label());
    let mut chart = axes(area, &title, x, y, None)?;
    let success = vec![(needed, 0.0), (needed, top)];
    line(&mut chart, success, MUTED.rgb.stroke_width(1), "depth that counts as inserted")?;
    let ended = path.last().copied();
    line(&mut chart, path, BLUE.rgb.stroke_width(2), "force")?;
    let colour = if recording.trial.outcome == Outcome::Inserted { BLUE } else { RED };
    points(&mut chart, ended, PointMark::dot(colour, 5), "end")?;
    legend(&mut chart, SeriesLabelPosition::UpperLeft)
}
