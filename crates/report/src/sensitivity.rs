//! Which input matters: table, JSON and chart.

use super::chart::{Area, Drawn, rows, sheet, tick, words};
use super::marks::{bar, label, line};
use super::theme::{BLUE, INK};
use super::{ReportError, text_table};
use insertion::evaluation::objective::Measure;
use parameters::Parameter;
use parameters::plan::saltelli::{Indices, Interval};
use plotters::prelude::Color;
use plotters::style::text_anchor::{HPos, VPos};
use serde_json::{Value, json};

/// Result of an analysis.
#[derive(Debug, Clone)]
pub struct Found {
    /// Name of the task.
    pub task: String,
    /// Measure analysed.
    pub objective: Measure,
    /// The inputs, as varied.
    pub factors: Vec<Parameter>,
    /// Shares of the objective's variance, in their order.
    pub indices: Vec<Indices>,
    /// Windows that were simulated.
    pub evaluations: usize,
    /// Those of them whose nominal start diverged: they count as 0.
    pub diverged: usize,
    /// Those whose nominal start fails: 0, too.
    pub without_window: usize,
}

impl Found {
    /// The inputs by how much they matter, most first.
    fn bars(&self) -> Vec<(&Parameter, Indices)> {
        let mut bars: Vec<_> = self.factors.iter().zip(self.indices.iter().copied()).collect();
        bars.sort_by(|a, b| b.1.total.value.total_cmp(&a.1.total.value));
        bars
    }
}

/// The inputs by how much they matter, for other programs.
pub fn json(found: &Found) -> Value {
    let one =
        |(Parameter { path, low, high, .. }, Indices { first, total }): (&Parameter, Indices)| {
            let mut fields = json!({"name": path, "low": low, "high": high});
            let mut set = |name: String, value: f64| fields[name] = json!(value);
            for (name, share) in [("first", first), ("total", total)] {
                set(name.to_owned(), share.value);
                set(format!("{name}_low"), share.low);
                set(format!("{name}_high"), share.high);
            }
            fields
        };
    json!({
        "task": found.task,
        "objective": found.objective.name(),
        "evaluations": found.evaluations,
        "diverged": found.diverged,
        "nominal_start_fails": found.without_window,
        "factors": found.bars().into_iter().map(one).collect::<Vec<_>>(),
    })
}

/// The same as a table of 80 columns.
pub fn text(found: &Found) -> String {
    let head = ["input", "total", "95 %", "alone", "95 %"];
    let interval = |of: Interval| format!("{:.2} to {:.2}", of.low, of.high);
    let rows = found.bars().into_iter().map(|(factor, Indices { first, total })| {
        let [value, alone] = [total, first].map(|share| format!("{:.2}", share.value));
        [short(&factor.path).to_owned(), value, interval(total), alone, interval(first)]
    });
    let table = text_table(1, head, rows);
    let counts =
        [(found.without_window, "fail at the nominal start"), (found.diverged, "diverge there")];
    let zeros = counts.iter().filter(|(count, _)| *count > 0);
    let zeros: Vec<String> =
        zeros.map(|(count, what)| format!("{count} {what} and count as 0")).collect();
    let zeros = zeros.iter().map(|zero| format!("; {zero}")).collect::<String>();
    format!(
        "{} of {}: which input matters, most first\n{table}\
         total: share of the variance that is left if all others are fixed; alone: share\n\
         that goes if this one is fixed\n{} windows simulated{zeros}\n",
        found.objective, found.task, found.evaluations
    )
}

/// A key without the path that all keys of a task have in common.
fn short(key: &str) -> &str {
    let key = key.strip_prefix("task.").unwrap_or(key);
    key.strip_prefix("strategy.").map_or(key, |rest| rest.strip_prefix("phase.").unwrap_or(rest))
}

/// Width of the chart, height of a row and of what is above and below them, room for the names;
/// pixels.
const WIDTH: u32 = 900;
const ROW: u32 = 34;
const HEAD_AND_FOOT: u32 = 110;
const LEFT: u32 = 300;

/// A bar for each input with its interval, most first.
pub fn svg(found: &Found) -> Result<String, ReportError> {
    let height = HEAD_AND_FOOT + ROW * found.factors.len() as u32;
    sheet("the sensitivity", (WIDTH, height), |area| draw(area, found))
}

fn draw(area: &Area<'_>, found: &Found) -> Drawn {
    let bars = found.bars();
    let largest = bars.iter().map(|(_, of)| of.total.high.max(of.total.value)).fold(1e-9, f64::max);
    let title = format!("{} of {}: shares of the variance", found.objective, found.task);
    let note = "share of the variance; bar: with all it acts with (total), line: 95 %; dark: alone";
    let mut chart = rows(area, &title, (note, 0.0..1.1 * largest), bars.len(), LEFT)?;
    for (row, (factor, Indices { first, total })) in bars.iter().enumerate() {
        let y = -0.5 - row as f64;
        let shares = [(total.value, 0.3, BLUE, 0.6), (first.value, 0.15, INK, 0.7)];
        for (share, half, colour, opacity) in shares {
            let style = colour.rgb().mix(opacity).filled();
            bar(&mut chart, [0.0, share.max(0.0)], [y - half, y + half], style)?;
        }
        let [low, high] = [total.low, total.high].map(|share| (share.max(0.0), y));
        line(&mut chart, vec![low, high], INK.rgb().stroke_width(2), "")?;
        let name =
            format!("{} ({} to {})", short(&factor.path), tick(factor.low), tick(factor.high));
        let style = words(13, INK, HPos::Right, VPos::Center);
        label(&mut chart, (0.0, y), (-8, 0), &name, &style)?;
        let style = words(14, INK, HPos::Left, VPos::Center);
        label(&mut chart, high, (8, 0), &format!("{:.2}", total.value), &style)?;
    }
    Ok(())
}
