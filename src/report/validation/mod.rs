//! Figures of `optimize validate`, after those of the publication.

mod bench;
mod direction;
mod failures;
mod scatter;
mod stiffness;
#[cfg(test)]
mod tests;

pub use bench::calibrated_svg;

use super::ReportError;
use super::chart::{Area, Drawn, message, words};
use super::theme::{BLUE, Colour, GREEN, INK, MUTED, ORANGE, RED};
use crate::verify::compare::published::{RangeSource, TaskTable};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Height of the strip with title and note, pixels.
const HEAD: u32 = 64;
/// Height of the strip with the key, pixels.
const KEY: u32 = 44;
/// Colours of things that are told apart: tasks, directions.
const SERIES: [Colour; 5] = [BLUE, GREEN, ORANGE, RED, MUTED];

/// All figures as `(file name, SVG)`.
///
/// # Errors
/// If the drawing library refuses.
pub fn figures(tables: &[TaskTable]) -> Result<Vec<(String, String)>, ReportError> {
    let mut figures = vec![
        ("simulated_against_bench.svg".to_owned(), scatter::svg(tables)?),
        ("range_against_direction.svg".to_owned(), direction::svg(tables)?),
        ("failures.svg".to_owned(), failures::svg(tables)?),
    ];
    for table in tables {
        let name = format!("range_against_stiffness_{}.svg", table.task);
        figures.push((name, stiffness::svg(table)?));
    }
    Ok(figures)
}

/// Title and a line below it; gives the rest of the sheet.
fn headed<'a>(area: &Area<'a>, title: &str, note: &str) -> Result<Area<'a>, String> {
    let (head, body) = area.split_vertically(HEAD);
    let top = |size, colour| words(size, colour, HPos::Left, VPos::Top);
    head.draw_text(title, &top(21, INK), (20, 12)).map_err(message)?;
    head.draw_text(note, &top(15, MUTED), (20, 40)).map_err(message)?;
    Ok(body)
}

/// One entry of a key: draws its mark at a pixel and says what it stands for.
struct Entry<'a> {
    mark: Mark,
    name: &'a str,
}

/// A mark of a plot.
#[derive(Debug, Clone, Copy)]
enum Mark {
    /// A filled circle of a radius, pixels.
    Disc(Colour, i32),
    /// An open triangle.
    Triangle(Colour),
    /// A cross.
    Cross(Colour),
}

impl Mark {
    /// The mark of a source wherever sources are told apart.
    fn of(source: RangeSource) -> Self {
        match source {
            RangeSource::Ours => Mark::Disc(BLUE, 5),
            RangeSource::Simulation => Mark::Triangle(ORANGE),
            RangeSource::Bench => Mark::Cross(GREEN),
        }
    }

    fn colour(self) -> Colour {
        match self {
            Mark::Disc(colour, _) | Mark::Triangle(colour) | Mark::Cross(colour) => colour,
        }
    }

    /// Draws it at a pixel.
    fn draw(self, area: &Area<'_>, at: (i32, i32)) -> Drawn {
        let line = |colour: Colour| colour.rgb().stroke_width(2);
        match self {
            Mark::Disc(colour, radius) => {
                let fill = Circle::new(at, radius, colour.rgb().mix(0.7).filled());
                area.draw(&fill).map_err(message)?;
                area.draw(&Circle::new(at, radius, colour.rgb())).map_err(message)
            }
            Mark::Triangle(colour) => {
                area.draw(&TriangleMarker::new(at, 6, line(colour))).map_err(message)
            }
            Mark::Cross(colour) => area.draw(&Cross::new(at, 5, line(colour))).map_err(message),
        }
    }
}

/// A key in one line, from left to right, starting `left` pixels in.
fn key(area: &Area<'_>, left: i32, entries: &[Entry<'_>]) -> Drawn {
    let style = words(15, INK, HPos::Left, VPos::Center);
    let mut x = left;
    for entry in entries {
        entry.mark.draw(area, (x + 12, KEY as i32 / 2))?;
        area.draw_text(entry.name, &style, (x + 30, KEY as i32 / 2)).map_err(message)?;
        x += 52 + 8 * entry.name.chars().count() as i32;
    }
    Ok(())
}

/// All ranges of some tables, mm.
fn ranges(tables: &[TaskTable]) -> impl Iterator<Item = f64> {
    let sources = [RangeSource::Ours, RangeSource::Simulation, RangeSource::Bench];
    let rows = tables.iter().flat_map(|table| &table.rows);
    rows.flat_map(move |row| sources.map(|source| row.range_mm(source))).flatten()
}

/// Top of an axis of ranges from 0, mm.
fn top(tables: &[TaskTable]) -> f64 {
    (1.1 * ranges(tables).fold(1.0, f64::max)).ceil()
}

/// The distinct values, smallest first.
fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
