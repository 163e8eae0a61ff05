//! Plot of a capture map.

use super::ReportError;
use super::chart::{Area, DrawResult, HPos, VPos, axes, render, text_style};
use super::marks::{PointMark, bar, points};
use super::theme::{
    Colour, DIVERGED, INK, INSERTED, JAMMED, LOST, LOST_EARLY, MISSED, MUTED, PAPER,
};
use crate::answer::words::outcome as numbered;
use analysis::map::{CaptureMap, MapAxis, OutcomeCode};
use insertion::{FailureClass, Outcome};
use plotters::prelude::*;

/// Outcomes and their colours, in the order of the legend.
const COLOURS: [(Outcome, Colour); 6] = [
    (Outcome::Inserted, INSERTED),
    (Outcome::Failed(FailureClass::ContactLossBeforeSearch), LOST_EARLY),
    (Outcome::Failed(FailureClass::PlugMissed), MISSED),
    (Outcome::Failed(FailureClass::Jammed), JAMMED),
    (Outcome::Failed(FailureClass::ContactLossInInsertion), LOST),
    (Outcome::Diverged, DIVERGED),
];
/// Width, and height without title and legend, pixels; narrow, so that the text stays legible on a phone.
const SIZE: (u32, u32) = (356, 300);
/// Height of a row of the title and of the legend, pixels.
const ROW: i32 = 22;
/// Left margin of title and legend, pixels.
const LEFT: i32 = 14;

/// Returns every outcome with its number in a map (0 inserted, 1 to 4 the failure class, -1 diverged), its label,
/// and its colour on a light page, `#RRGGBB`.
pub fn outcomes() -> [(i8, &'static str, String); 6] {
    COLOURS.map(|(outcome, colour)| (OutcomeCode(outcome).into(), outcome.label(), colour.hex()))
}

/// Draws the outcome at each grid point as a coloured rectangle, with a dot if it was simulated.
///
/// # Errors
/// If the drawing library fails.
pub fn svg(map: &CaptureMap) -> Result<String, ReportError> {
    let head = head(map);
    let rows = head.iter().map(Vec::len).sum::<usize>() as u32;
    let height = ROW as u32 * rows + 10;
    render("the capture map", (SIZE.0, SIZE.1 + height), |area| {
        let (top, body) = area.split_vertically(height);
        let [title, legend] = &head;
        let text = |size| text_style(size, INK, HPos::Left, VPos::Center);
        let mut middles = (0..).map(|row| ROW * row + 18);
        for (parts, y) in title.iter().zip(&mut middles) {
            let line = parts.iter().map(|(text, ..)| &**text).collect::<Vec<_>>().join(" ");
            top.draw_text(&line, &text(17), (LEFT, y))?;
        }
        for (row, y) in legend.iter().zip(middles) {
            for (entry, colour, x) in row {
                let square = [(x - 20, y - 7), (x - 6, y + 7)];
                match colour {
                    Some(colour) => top.draw(&Rectangle::new(square, colour.rgb.filled())),
                    None => top.draw(&Circle::new((x - 13, y), 2, MUTED.rgb.filled())),
                }?;
                top.draw_text(entry, &text(15), (*x, y))?;
            }
        }
        draw(&body, map)
    })
}

/// Text of title or legend with the colour of its outcome, if it is one, and its left end, pixels.
type Entry = (String, Option<Colour>, i32);

/// Arranges texts, each with `before` pixels for a mark to its left, in rows that are no wider than the map.
fn wrapped(
    texts: impl IntoIterator<Item = (String, Option<Colour>)>,
    before: i32,
) -> Vec<Vec<Entry>> {
    let (mut rows, mut row, mut left) = (Vec::new(), Vec::new(), LEFT);
    for (text, colour) in texts {
        // 8 pixels per character are enough for the usual fonts.
        let width = before + 8 * text.chars().count() as i32;
        if left > LEFT && left + width > SIZE.0 as i32 {
            rows.push(std::mem::take(&mut row));
            left = LEFT;
        }
        row.push((text, colour, left + before));
        left += width + 8;
    }
    rows.push(row);
    rows
}

/// Returns the rows of the title and of the legend below.
fn head(map: &CaptureMap) -> [Vec<Vec<Entry>>; 2] {
    let area =
        format!("area of the map that inserts {:.1} {}", map.area, map.area_unit.replace('2', "²"));
    let design = map.design.labelled();
    let of = [&*map.task, &design].into_iter().filter(|text| !text.is_empty());
    let of = of.flat_map(|text| text.split(", ")).map(|part| format!("{part},"));
    let title = wrapped(of.chain([area]).map(|text| (text, None)), 0);
    let occurs = |outcome| map.outcomes.iter().flatten().any(|mark| mark.0 == outcome);
    let shown = COLOURS.into_iter().filter(|(outcome, _)| occurs(*outcome));
    let entries = shown.map(|(outcome, colour)| (numbered(outcome), Some(colour)));
    [title, wrapped(entries.chain([("simulated".to_owned(), None)]), 20)]
}

fn draw(area: &Area<'_>, map: &CaptureMap) -> DrawResult {
    let half = |axis: &MapAxis| axis.step / 2.0;
    let range = |axis: &MapAxis| axis.low - half(axis)..axis.high + half(axis);
    let name = |axis: &MapAxis| format!("error of the start: {} ({})", axis.name, axis.unit);
    let [first, second] = &map.axes;
    let (x_name, y_name) = (name(first), format!("{} ({})", second.name, second.unit));
    let mut chart = axes(area, "", (&x_name, range(first)), (&y_name, range(second)), None)?;
    for (at, row) in map.outcomes.iter().enumerate() {
        let y = second.value(at);
        let mut from = 0;
        // One rectangle for adjacent points with equal outcomes.
        for stretch in row.chunk_by(|a, b| a == b) {
            let to = from + stretch.len();
            let colour = COLOURS.into_iter().find(|(outcome, _)| *outcome == stretch[0].0);
            let x = [from, to].map(|at| first.value(at) - half(first));
            let style = colour.map_or(PAPER, |(_, colour)| colour).rgb.filled();
            bar(&mut chart, x, [y - half(second), y + half(second)], style)?;
            from = to;
        }
    }
    for (at, (row, marks)) in map.simulated.iter().zip(&map.outcomes).enumerate() {
        for (i, (_, mark)) in row.iter().zip(marks).enumerate().filter(|(_, (is, _))| **is) {
            let colour = if mark.0 == Outcome::Inserted { LOST_EARLY } else { INSERTED };
            let dot = PointMark::disc(colour, 1);
            points(&mut chart, [(first.value(i), second.value(at))], dot, "")?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
