//! Sensitivity of the range to its inputs: table, JSON and chart.

use super::chart::{Area, DrawResult, HPos, VPos, render, rows, text_style};
use super::marks::{bar, label, line};
use super::theme::{BLUE, INK};
use super::{ReportError, text_table};
use analysis::levers::thousandths;
use parameters::Parameter;
use parameters::plan::saltelli::Indices;
use plotters::prelude::Color;
use serde::Serialize;

/// Result of a sensitivity analysis, as `--json` prints it.
#[derive(Debug, Clone, Serialize)]
pub struct SensitivityResult {
    /// Name of the task.
    pub task: String,
    /// Number of simulated windows.
    pub evaluations: usize,
    /// Number of windows whose nominal start diverged; they count as 0.
    pub diverged: usize,
    /// Number of windows whose nominal start fails; they count as 0.
    pub nominal_start_fails: usize,
    /// The inputs (factors), by total index, largest first.
    pub factors: Vec<Factor>,
}

/// Input: path, bounds in its unit, and Sobol indices.
#[derive(Debug, Clone, Serialize)]
pub struct Factor {
    name: String,
    low: f64,
    high: f64,
    #[serde(flatten)]
    indices: Indices,
}

impl Factor {
    /// Returns the factors of these inputs, largest total index first.
    pub fn sorted(inputs: &[Parameter], indices: &[Indices]) -> Vec<Self> {
        let factor = |(input, &indices): (&Parameter, &Indices)| {
            let (name, low, high) = (input.path.to_string(), input.low, input.high);
            Factor { name, low, high, indices }
        };
        let mut factors: Vec<_> = inputs.iter().zip(indices).map(factor).collect();
        factors.sort_by(|a, b| b.indices.total.total_cmp(&a.indices.total));
        factors
    }
}

/// Returns the result as a table within 80 columns.
pub fn text(found: &SensitivityResult) -> String {
    let head = ["input", "total", "95 %", "alone", "95 %"];
    let interval = |low: f64, high: f64| format!("{low:.2} to {high:.2}");
    let rows = found.factors.iter().map(|factor| {
        let Indices { first, first_low, first_high, total, total_low, total_high } = factor.indices;
        let (of_total, of_first) =
            (interval(total_low, total_high), interval(first_low, first_high));
        let [total, first] = [total, first].map(|share| format!("{share:.2}"));
        [short(&factor.name).to_owned(), total, of_total, first, of_first]
    });
    let table = text_table(1, head, rows);
    let counts = [(found.nominal_start_fails, "fail"), (found.diverged, "diverge")];
    let zeros = counts.iter().filter(|(count, _)| *count > 0);
    let zeros: String = zeros
        .map(|(count, what)| format!("; {count} {what} at the nominal start and count as 0"))
        .collect();
    format!(
        "range of {}: inputs by influence\n{table}\
         total: share of the variance that remains if all others are fixed (total index)\n\
         alone: share that vanishes if this one is fixed (first-order index)\n\
         {} windows simulated{zeros}\n",
        found.task, found.evaluations
    )
}

/// Removes the longest of `task.`, `task.strategy.` and `task.strategy.phase.` with which a path begins.
fn short(key: &str) -> &str {
    let key = key.strip_prefix("task.").unwrap_or(key);
    key.strip_prefix("strategy.").map_or(key, |rest| rest.strip_prefix("phase.").unwrap_or(rest))
}

/// Width of the chart, height of a row, height of head and foot together, and width of the names, pixels.
const WIDTH: u32 = 900;
const ROW: u32 = 34;
const HEAD_AND_FOOT: u32 = 110;
const LEFT: u32 = 300;

/// Draws the indices of each input as bars, largest total index first, with the interval of that index.
pub fn svg(found: &SensitivityResult) -> Result<String, ReportError> {
    let height = HEAD_AND_FOOT + ROW * found.factors.len() as u32;
    render("the sensitivity", (WIDTH, height), |area| draw(area, found))
}

fn draw(area: &Area<'_>, found: &SensitivityResult) -> DrawResult {
    let factors = &found.factors;
    let highest = |factor: &Factor| factor.indices.total_high.max(factor.indices.total);
    let largest = factors.iter().map(highest).fold(1e-9, f64::max);
    let title = format!("range of {}: shares of the variance", found.task);
    let note =
        "share of the variance; light bar: total index, line: its 95 % interval; dark: first-order";
    let mut chart = rows(area, &title, (note, 0.0..1.1 * largest), factors.len(), LEFT)?;
    for (row, factor) in factors.iter().enumerate() {
        let y = -0.5 - row as f64;
        let Indices { first, total, total_low, total_high, .. } = factor.indices;
        let shares = [(total, 0.3, BLUE, 0.6), (first, 0.15, INK, 0.7)];
        for (share, half, colour, opacity) in shares {
            let style = colour.rgb.mix(opacity).filled();
            bar(&mut chart, [0.0, share.max(0.0)], [y - half, y + half], style)?;
        }
        let [low, high] = [total_low, total_high].map(|share| (share.max(0.0), y));
        line(&mut chart, vec![low, high], INK.rgb.stroke_width(2), "")?;
        let name = short(&factor.name);
        let name = format!("{name} ({} to {})", thousandths(factor.low), thousandths(factor.high));
        let style = text_style(13, INK, HPos::Right, VPos::Center);
        label(&mut chart, (0.0, y), (-8, 0), &name, &style)?;
        let style = text_style(14, INK, HPos::Left, VPos::Center);
        label(&mut chart, high, (8, 0), &format!("{total:.2}"), &style)?;
    }
    Ok(())
}
