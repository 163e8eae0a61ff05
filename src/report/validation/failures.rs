//! How often each pair of failure classes met at a window's end.

use super::super::ReportError;
use super::super::chart::{Area, Drawn, message, sheet, words};
use super::super::theme::{INK, LINES, MUTED, ORANGE, PAPER, SCALE};
use super::{HEAD, headed};
use crate::outcome::FailureClass;
use crate::verify::compare::published::{Agreement, RangeSource, TaskTable};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Side of a cell, pixels.
const CELL: i32 = 50;
/// Room left of, and above, the cells of a panel, pixels.
const LEFT: i32 = 84;
const ABOVE: i32 = 76;
/// Size of a panel, pixels.
const WIDTH: u32 = 300;
const HEIGHT: u32 = 392;
/// Names of the classes along an axis; the last stands for no class at all.
const NAMES: [&str; 5] = ["1 early", "2 missed", "3 jammed", "4 lost", "none"];

/// Ours above, the published simulation below; one column per task.
pub(super) fn svg(tables: &[TaskTable]) -> Result<String, ReportError> {
    let columns = tables.len().max(1);
    let size = ((WIDTH * columns as u32 + 20).max(700), 2 * HEIGHT + HEAD);
    sheet("failures", size, |area| {
        let title = "Failures at the ends of the windows: simulated against bench experiments";
        let note = "number of window ends · frame: same class in both · \
                    score: share of ends with the same class";
        let body = headed(area, title, note)?;
        for (row, source) in [RangeSource::Ours, RangeSource::Simulation].into_iter().enumerate() {
            for (column, table) in tables.iter().enumerate() {
                let corner = (WIDTH * column as u32, HEIGHT * row as u32);
                let panel = body.clone().shrink(corner, (WIDTH, HEIGHT));
                draw(&panel, table, source)?;
            }
        }
        Ok(())
    })
}

/// Counts of `[simulated][bench]`; index 4 simulated is "no class".
fn counts(table: &TaskTable, source: RangeSource) -> [[u32; 4]; 5] {
    let index = |class: Option<FailureClass>| class.map_or(4, |class| class as usize);
    let mut counts = [[0; 4]; 5];
    for row in &table.rows {
        let (Some(simulated), Some(bench)) = (row.reading(source), row.reading(RangeSource::Bench))
        else {
            continue;
        };
        for (simulated, bench) in simulated.failures.into_iter().zip(bench.failures) {
            if let Some(bench) = bench {
                counts[index(simulated)][bench as usize] += 1;
            }
        }
    }
    counts
}

fn draw(area: &Area<'_>, table: &TaskTable, source: RangeSource) -> Drawn {
    let counts = counts(table, source);
    let found = Agreement::of(&table.rows, source, RangeSource::Bench);
    let score = found.match_percent().map_or("–".to_owned(), |p| format!("{p:.1} %"));
    let text = |words: TextStyle<'static>, at: (i32, i32), string: &str| {
        area.draw_text(string, &words, at).map_err(message)
    };
    let left = |size, colour| words(size, colour, HPos::Left, VPos::Top);
    text(left(18, INK), (20, 8), &format!("{}, {}", table.task, source.label()))?;
    let matched = format!("score {score} ({} of {} ends)", found.matched_ends, found.ends);
    text(left(15, MUTED), (20, 34), &matched)?;
    // A row for "no class" only where it happened.
    let rows = if counts[4].iter().any(|&n| n > 0) { 5 } else { 4 };
    let most = counts.iter().flatten().copied().max().unwrap_or(0).max(1);
    for (simulated, line) in counts.iter().enumerate().take(rows) {
        let y = ABOVE + CELL * simulated as i32;
        text(
            words(14, INK, HPos::Right, VPos::Center),
            (LEFT - 6, y + CELL / 2),
            NAMES[simulated],
        )?;
        for (bench, &count) in line.iter().enumerate() {
            cell(area, (LEFT + CELL * bench as i32, y), count, most)?;
        }
    }
    let corner = (LEFT - 6, ABOVE - 4);
    text(words(14, MUTED, HPos::Right, VPos::Bottom), corner, "simulated")?;
    for class in 0..4 {
        let at = LEFT + CELL * class;
        let corners = [(at, ABOVE + CELL * class), (at + CELL, ABOVE + CELL * (class + 1))];
        let frame = Rectangle::new(corners, ORANGE.rgb().stroke_width(2));
        area.draw(&frame).map_err(message)?;
        let below = (at + CELL / 2, ABOVE + CELL * rows as i32 + 6);
        let name = NAMES[class as usize].split(' ').next().unwrap_or_default();
        text(words(14, INK, HPos::Center, VPos::Top), below, name)?;
    }
    let below = (LEFT + 2 * CELL, ABOVE + CELL * rows as i32 + 26);
    text(words(14, MUTED, HPos::Center, VPos::Top), below, "class in the bench experiments")
}

/// One cell: darker for more, white without any.
fn cell(area: &Area<'_>, (x, y): (i32, i32), count: u32, most: u32) -> Drawn {
    let corners = [(x, y), (x + CELL, y + CELL)];
    let level = (count as usize * (SCALE.len() - 1)).div_ceil(most as usize);
    let (fill, ink) = match (count, level) {
        (0, _) => (PAPER, LINES),
        (_, 0..3) => (SCALE[level], INK),
        _ => (SCALE[level], PAPER),
    };
    area.draw(&Rectangle::new(corners, fill.rgb().filled())).map_err(message)?;
    area.draw(&Rectangle::new(corners, LINES.rgb())).map_err(message)?;
    if count == 0 {
        return Ok(());
    }
    let style = words(17, ink, HPos::Center, VPos::Center);
    area.draw_text(&count.to_string(), &style, (x + CELL / 2, y + CELL / 2)).map_err(message)
}
