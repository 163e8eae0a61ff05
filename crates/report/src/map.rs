//! The capture map as a picture.

use super::ReportError;
use super::chart::{Area, Drawn, axes, message, sheet, words};
use super::theme::{
    Colour, DIVERGED, INK, INSERTED, JAMMED, LOST, LOST_EARLY, MISSED, MUTED, PAPER,
};
use crate::answer::words::outcome as numbered;
use analysis::map::{Axis, CaptureMap};
use insertion::outcome::{FailureClass, Outcome};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Every outcome with its colour, in the order of the legend.
const COLOURS: [(Outcome, Colour); 6] = [
    (Outcome::Inserted, INSERTED),
    (Outcome::Failed(FailureClass::ContactLossBeforeSearch), LOST_EARLY),
    (Outcome::Failed(FailureClass::PlugMissed), MISSED),
    (Outcome::Failed(FailureClass::Jammed), JAMMED),
    (Outcome::Failed(FailureClass::ContactLossInInsertion), LOST),
    (Outcome::Diverged, DIVERGED),
];
/// Width, and height without title and legend, pixels: on a phone the text stays legible.
const SIZE: (u32, u32) = (356, 300);
/// Height of a row of the title and of the legend, pixels.
const ROW: i32 = 22;
const LEFT: i32 = 14;

/// Returns every outcome with its number in a map (0 inserted, 1 to 4 the failure class, -1 diverged), its label,
/// and its colour on a light page, `#RRGGBB`.
pub fn outcomes() -> [(i8, &'static str, String); 6] {
    COLOURS.map(|(outcome, colour)| {
        let number = match outcome {
            Outcome::Inserted => 0,
            Outcome::Failed(class) => u8::from(class) as i8,
            Outcome::Diverged => -1,
        };
        (number, outcome.label(), colour.hex())
    })
}

/// Draws the outcome at each place, with a dot where it was simulated.
///
/// # Errors
/// If the drawing library fails.
pub fn svg(map: &CaptureMap) -> Result<String, ReportError> {
    let head = head(map);
    let rows = head[1].last().map_or(0, |entry| entry.at.1 + 1);
    let height = (ROW * rows) as u32 + 10;
    sheet("the capture map", (SIZE.0, SIZE.1 + height), |area| {
        let (top, body) = area.split_vertically(height);
        draw_head(&top, &head)?;
        draw(&body, map)
    })
}

/// Text of title or legend with its colour and its position: pixels from the left, and row.
struct Entry {
    text: String,
    colour: Option<Colour>,
    at: (i32, i32),
}

/// Places texts in rows from `first` on, each after `before` pixels; no row is wider than the map.
fn placed(
    texts: impl IntoIterator<Item = (String, Option<Colour>)>,
    before: i32,
    first: i32,
) -> Vec<Entry> {
    let mut next = (LEFT, first);
    let place = |(text, colour): (String, _)| {
        // Wide enough for the usual fonts.
        let width = before + 8 * text.chars().count() as i32;
        if next.0 > LEFT && next.0 + width > SIZE.0 as i32 {
            next = (LEFT, next.1 + 1);
        }
        let at = (next.0 + before, next.1);
        next.0 += width + 8;
        Entry { text, colour, at }
    };
    texts.into_iter().map(place).collect()
}

/// Returns the parts of the title and the entries of the legend below.
fn head(map: &CaptureMap) -> [Vec<Entry>; 2] {
    let area = format!("area that inserts {:.1} {}", map.area, map.area_unit.replace('2', "²"));
    let design = map.design.labelled();
    let of = [&*map.task, &design].into_iter().filter(|text| !text.is_empty());
    let of = of.flat_map(|text| text.split(", ")).map(|part| format!("{part},"));
    let title = placed(of.chain([area]).map(|text| (text, None)), 0, 0);
    let met = |outcome| map.outcomes.iter().flatten().any(|mark| mark.0 == outcome);
    let met = COLOURS.into_iter().filter(|(outcome, _)| met(*outcome));
    let entries = met.map(|(outcome, colour)| (numbered(outcome), Some(colour)));
    let rows = title.last().map_or(0, |part| part.at.1 + 1);
    [title, placed(entries.chain([("simulated".to_owned(), None)]), 20, rows)]
}

fn draw_head(area: &Area<'_>, [title, entries]: &[Vec<Entry>; 2]) -> Drawn {
    let text = |size| words(size, INK, HPos::Left, VPos::Center);
    let middle = |row: i32| ROW * row + 18;
    for parts in title.chunk_by(|a, b| a.at.1 == b.at.1) {
        let line = parts.iter().map(|part| &*part.text).collect::<Vec<_>>().join(" ");
        let row = parts.first().map_or(0, |part| part.at.1);
        area.draw_text(&line, &text(17), (LEFT, middle(row))).map_err(message)?;
    }
    for Entry { text: entry, colour, at: (x, row) } in entries {
        let (left, y) = (x - 20, middle(*row));
        match colour {
            Some(colour) => area
                .draw(&Rectangle::new([(left, y - 7), (left + 14, y + 7)], colour.rgb().filled())),
            None => area.draw(&Circle::new((left + 7, y), 2, MUTED.rgb().filled())),
        }
        .map_err(message)?;
        area.draw_text(entry, &text(15), (*x, y)).map_err(message)?;
    }
    Ok(())
}

fn draw(area: &Area<'_>, map: &CaptureMap) -> Drawn {
    let half = |axis: &Axis| axis.step / 2.0;
    let range = |axis: &Axis| axis.low - half(axis)..axis.high + half(axis);
    let name = |axis: &Axis| format!("error of the start: {} ({})", axis.name, axis.unit);
    let [first, second] = &map.axes;
    let (x_name, y_name) = (name(first), format!("{} ({})", second.name, second.unit));
    let mut chart = axes(area, "", (&x_name, range(first)), (&y_name, range(second)))?;
    for (at, row) in map.outcomes.iter().enumerate() {
        let y = second.value(at);
        let mut from = 0;
        // Neighbours with equal outcomes are one rectangle.
        for stretch in row.chunk_by(|a, b| a == b) {
            let to = from + stretch.len();
            let outcome = stretch.first().map(|mark| mark.0);
            let colour = COLOURS.into_iter().find(|(of, _)| Some(*of) == outcome);
            let corners = [
                (first.value(from) - half(first), y - half(second)),
                (first.value(to) - half(first), y + half(second)),
            ];
            let style = colour.map_or(PAPER, |(_, colour)| colour).rgb().filled();
            chart.draw_series([Rectangle::new(corners, style)]).map_err(message)?;
            from = to;
        }
    }
    let dots =
        map.simulated.iter().zip(&map.outcomes).enumerate().flat_map(|(at, (row, marks))| {
            let simulated = row.iter().zip(marks).enumerate().filter(|(_, (is, _))| **is);
            simulated.map(move |(i, (_, mark))| {
                let colour = if mark.0 == Outcome::Inserted { LOST_EARLY } else { INSERTED };
                Circle::new((first.value(i), second.value(at)), 1, colour.rgb().filled())
            })
        });
    chart.draw_series(dots).map(|_| ()).map_err(message)
}

#[cfg(test)]
mod tests;
