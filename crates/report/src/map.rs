//! The capture map as a picture.

use super::ReportError;
use super::chart::{Area, Drawn, axes, message, sheet, words};
use super::theme::{BLUE, Colour, GREEN, INK, LINES, MUTED, ORANGE, PAPER, RED};
use analysis::map::{Axis, CaptureMap};
use insertion::outcome::{FailureClass, Outcome};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Every outcome with its colour, in the order of the legend.
const COLOURS: [(Outcome, Colour); 6] = [
    (Outcome::Inserted, GREEN),
    (Outcome::Failed(FailureClass::ContactLossBeforeSearch), INK),
    (Outcome::Failed(FailureClass::PlugMissed), BLUE),
    (Outcome::Failed(FailureClass::Jammed), ORANGE),
    (Outcome::Failed(FailureClass::ContactLossInInsertion), RED),
    (Outcome::Diverged, LINES),
];
const SIZE: (u32, u32) = (600, 430);
/// Height of title and legend, pixels.
const HEAD: u32 = 66;

/// Every outcome as a map has it: its number (0 inserted, 1 to 4 the failure class, -1 diverged), its words, and
/// its colour on a light page, `#RRGGBB`.
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

/// The outcome at each place, a dot where it was simulated.
///
/// # Errors
/// If the drawing library refuses.
pub fn svg(map: &CaptureMap) -> Result<String, ReportError> {
    sheet("the capture map", SIZE, |area| {
        let (head, body) = area.split_vertically(HEAD);
        legend(&head, map)?;
        draw(&body, map)
    })
}

fn legend(area: &Area<'_>, map: &CaptureMap) -> Drawn {
    let text = |size, colour| words(size, colour, HPos::Left, VPos::Center);
    let design = map.design.labelled();
    let comma = if design.is_empty() { "" } else { ", " };
    let unit = map.area_unit.replace('2', "²");
    let title = format!("{}{comma}{design}: {:.1} {unit} insert", map.task, map.area);
    area.draw_text(&title, &text(19, INK), (20, 22)).map_err(message)?;
    let met = |outcome| map.outcomes.iter().flatten().any(|mark| mark.0 == outcome);
    let mut x = 20;
    for (outcome, colour) in COLOURS.into_iter().filter(|(outcome, _)| met(*outcome)) {
        area.draw(&Rectangle::new([(x, 44), (x + 14, 58)], filled(colour))).map_err(message)?;
        area.draw_text(outcome.label(), &text(15, INK), (x + 20, 52)).map_err(message)?;
        x += 44 + 8 * outcome.label().len() as i32;
    }
    area.draw(&Circle::new((x + 6, 51), 2, MUTED.rgb().filled())).map_err(message)?;
    area.draw_text("simulated", &text(15, INK), (x + 16, 52)).map_err(message)
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
        // What ends alike side by side is one rectangle.
        for stretch in row.chunk_by(|a, b| a == b) {
            let to = from + stretch.len();
            let colour = COLOURS
                .into_iter()
                .find(|(outcome, _)| Some(*outcome) == stretch.first().map(|mark| mark.0));
            let corners = [
                (first.value(from) - half(first), y - half(second)),
                (first.value(to) - half(first), y + half(second)),
            ];
            let style = filled(colour.map_or(PAPER, |(_, colour)| colour));
            chart.draw_series([Rectangle::new(corners, style)]).map_err(message)?;
            from = to;
        }
    }
    let dots = map.simulated.iter().enumerate().flat_map(|(at, row)| {
        let simulated = row.iter().enumerate().filter(|(_, is)| **is);
        simulated.map(move |(i, _)| (first.value(i), second.value(at)))
    });
    let dots = dots.map(|at| Circle::new(at, 1, MUTED.rgb().filled()));
    chart.draw_series(dots).map(|_| ()).map_err(message)
}

/// So that dots and the grid are seen on it.
fn filled(colour: Colour) -> ShapeStyle {
    colour.rgb().mix(0.5).filled()
}
