//! True windows of measured fingers in hidden cells, and the windows that our engine has for them.

use super::{HIDDEN, HiddenCell};
use ask_tell::statistics::{mean, spearman};
use finger_opt::failure::Failure;
use insertion::evaluation::evaluator::Specimen;
use insertion::evaluation::taught::{Moved, Taught, teach};
use insertion::evaluation::tolerance::{self, Search};
use insertion::evaluation::{OffsetStep, Window, grid_mm};
use insertion::outcome::Outcome;
use insertion::robot::Robot;
use insertion::space::{DENSITY_KEY, DIRECTION_KEY, Design};
use insertion::stiffness::Measurement;
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use std::collections::BTreeMap;
use std::time::Instant;

/// In the other engine, in ours, and in ours with the cell as the files have it.
const WAYS: [&str; 3] = ["truth", "direct", "nominal"];
/// Columns of a way after its name. Ends count from the task's own start, not from the taught one.
const COLUMNS: [&str; 6] =
    ["start_mm", "negative_mm", "positive_mm", "range_mm", "failure_negative", "failure_positive"];

/// What the table knows of a finger in a cell, mm.
#[derive(Debug, Clone, Copy, Default)]
pub struct Known {
    /// The start that was taught.
    pub start: f64,
    /// The farthest starts that insert.
    pub negative: f64,
    /// ... towards +y.
    pub positive: f64,
    /// The true range.
    pub range: f64,
    /// The range with the cell as the files have it.
    pub nominal: f64,
}

/// What the rows know of a finger.
pub fn known(rows: &Rows, cell: u64, design: &Design) -> Option<Known> {
    let header = header();
    let columns: Vec<&str> = header.split(',').collect();
    let number = |row: &str, name: &str| {
        let at = columns.iter().position(|column| *column == name)?;
        row.split(',').nth(at)?.parse::<f64>().ok()
    };
    let is = |row: &&String| {
        [DENSITY_KEY, DIRECTION_KEY].iter().all(|key| number(row, key) == design.get(key))
    };
    let row = rows.iter().filter(|((of, _), _)| *of == cell).map(|(_, row)| row).find(is)?;
    let mm = |name: &str| number(row, name).unwrap_or(0.0);
    Some(Known {
        start: mm("truth_start_mm"),
        negative: mm("truth_negative_mm"),
        positive: mm("truth_positive_mm"),
        range: mm("truth_range_mm"),
        nominal: mm("nominal_range_mm"),
    })
}

/// Rows of the table by cell and number of the finger.
pub type Rows = BTreeMap<(u64, u32), String>;

/// The header of the table.
pub fn header() -> String {
    let hidden = HIDDEN.map(|(_, column)| column).join(",");
    let ways = WAYS.map(|way| COLUMNS.map(|column| format!("{way}_{column}")).join(",")).join(",");
    format!(
        "cell,design,task,draws,{hidden},infill_density_percent,infill_direction_deg,{ways},\
         truth_taught_again,truth_elapsed_s"
    )
}

/// Rows of such a table; one that a kill has cut short is none.
///
/// # Errors
/// If it is another.
pub fn parse(text: &str) -> Result<Rows, Failure> {
    let header = header();
    let mut lines = text.split_inclusive('\n');
    if lines.next().is_some_and(|line| line.trim_end() != header) {
        return Err(Failure::usage(format!("the header must be '{header}'")));
    }
    let row = |line: &str| {
        let line = line.strip_suffix('\n')?;
        let mut cells = line.split(',');
        let name = (cells.next()?.parse().ok()?, cells.next()?.parse().ok()?);
        (cells.count() + 2 == header.split(',').count()).then(|| (name, line.to_owned()))
    };
    Ok(lines.filter_map(row).collect())
}

/// The row of a finger in a cell, whose true window is that in `engine`.
///
/// # Errors
/// If it cannot be simulated.
pub fn measure(
    cell: &HiddenCell<'_>,
    finger: &Measurement,
    engine: EngineKind,
) -> Result<String, Failure> {
    let Measurement { design: number, density_percent, direction_deg, .. } = *finger;
    let design = Design::infill(density_percent, direction_deg);
    let [hidden, nominal] = [cell.setup(&design)?, cell.nominal(&design)?];
    let direct = window(&hidden, EngineKind::Direct, None)?;
    let began = Instant::now();
    let near = direct.as_ref().map_or(0, |taught| taught.by);
    let truth = window(&hidden, engine, Some(near))?;
    let elapsed_s = began.elapsed().as_secs_f64();
    let again = u8::from(truth.as_ref().is_none_or(|truth| truth.by != near));
    let nominal = window(&nominal, EngineKind::Direct, None)?;
    let ways = [truth, direct, nominal].map(cells).join(",");
    let shown = cell.shown.map(|value| format!("{value:.4}")).join(",");
    let (HiddenCell { number: cell, draws, .. }, task) = (cell, &cell.template.task.name);
    Ok(format!(
        "{cell},{number},{task},{draws},{shown},{density_percent},{direction_deg},{ways},{again},\
         {elapsed_s:.1}"
    ))
}

/// The window about a start that inserts: `near`, or else a taught one; `None` if none inserts.
pub fn window(
    (specimen, robot): &(Specimen, Robot),
    engine: EngineKind,
    near: Option<OffsetStep>,
) -> Result<Option<Taught>, Failure> {
    let Specimen { task, finger, .. } = specimen;
    let rig = engine.rig(task, robot, finger, 1.0).map_err(Failure::input)?;
    if let Some(by) = near {
        let moved = Moved { rig: &*rig, by };
        let window = tolerance::evaluate(&moved, finger, Search::Strides).window;
        if window.nominal == Outcome::Inserted {
            return Ok(Some(Taught { by, window }));
        }
    }
    Ok(teach(&*rig, finger, &NEVER).ok())
}

/// The cells of a window; without one a range of 0 and no more.
fn cells(taught: Option<Taught>) -> String {
    let Some(Taught { by, window }) = taught else { return ",,,0,,".to_owned() };
    let Window { negative_steps, positive_steps, end_negative, end_positive, .. } = window;
    let [start, negative, positive] = [by, by + negative_steps, by + positive_steps].map(grid_mm);
    let code = |end: Option<Outcome>| match end {
        Some(Outcome::Failed(class)) => class.number().to_string(),
        Some(other) => other.word().to_owned(),
        None => String::new(),
    };
    let ends = [end_negative, end_positive].map(code).join(",");
    format!("{start},{negative},{positive},{},{ends}", window.range_mm())
}

/// How well either way of ours has the true ranges, a line for each cell.
pub fn summary(rows: &Rows) -> String {
    let column = |name: &str| header().split(',').position(|column| column == name);
    let places = WAYS.map(|way| column(&format!("{way}_range_mm")));
    let mut cells: BTreeMap<u64, Vec<Vec<&str>>> = BTreeMap::new();
    for ((cell, _), row) in rows {
        cells.entry(*cell).or_default().push(row.split(',').collect());
    }
    let hidden = HIDDEN.map(|(_, column)| column).join(" | ");
    let mut text = format!(
        "| cell | task | draws | {hidden} | fingers | mean range, mm | nominal: Spearman | error, \
         mm | direct: Spearman | error, mm |\n|{}\n",
        " --- |".repeat(14)
    );
    for (cell, rows) in &cells {
        let range = |way: usize, row: &[&str]| -> f64 {
            places[way].and_then(|at| row.get(at)?.parse().ok()).unwrap_or(0.0)
        };
        let pairs = |way| rows.iter().map(|row| (range(0, row), range(way, row))).collect();
        let judged = [2, 1].map(|way| {
            let pairs: Vec<(f64, f64)> = pairs(way);
            let errors = pairs.iter().map(|(truth, found)| (truth - found).abs());
            let order = spearman(&pairs).map_or("-".to_owned(), |found| format!("{found:+.2}"));
            format!("{order} | {:.2}", mean(errors).unwrap_or_default())
        });
        let truth = rows.iter().map(|row| range(0, row));
        let about = rows[0][2..4 + HIDDEN.len()].join(" | ");
        let (fingers, mean) = (rows.len(), mean(truth).unwrap_or_default());
        text += &format!("| {cell} | {about} | {fingers} | {mean:.2} | {} |\n", judged.join(" | "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_whole_stay_and_each_cell_is_summed_up() {
        let row = |design: u32, ranges: [f64; 3]| {
            let ways = ranges.map(|range| format!("0,-1,1,{range},3,4")).join(",");
            format!("2,{design},ket8,1,0.2,2,0.3,30,0.1,10,{design},{ways},0,1\n")
        };
        let fingers = [row(1, [5.0, 5.5, 9.0]), row(2, [6.0, 6.0, 8.0]), row(3, [7.0, 7.0, 7.0])];
        let text = format!("{}\n{}2,4,ket8,1,0.2", header(), fingers.concat());
        let rows = parse(&text).unwrap();
        assert_eq!(rows.len(), 3);
        let text = summary(&rows);
        let line =
            "| 2 | ket8 | 1 | 0.2 | 2 | 0.3 | 30 | 0.1 | 3 | 6.00 | -1.00 | 2.00 | +1.00 | 0.17 |";
        assert!(text.ends_with(&format!("{line}\n")), "{text}");
        assert!(parse("cell\n").is_err());
    }
}
