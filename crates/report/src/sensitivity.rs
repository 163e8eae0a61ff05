//! Which input matters: table, JSON and chart.

use super::ReportError;
use super::chart::{Area, Drawn, message, sheet, tick, words};
use super::theme::{BLUE, INK, LINES, MUTED};
use insertion::evaluation::objective::Measure;
use parameters::Parameter;
use parameters::plan::saltelli::{Indices, Interval};
use plotters::prelude::*;
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
    let head = ["total", "95 %", "alone", "95 %"];
    let interval = |of: Interval| format!("{:.2} to {:.2}", of.low, of.high);
    let mut lines = vec![
        format!("{} of {}: which input matters, most first", found.objective, found.task),
        format!("{:<33} {:>10} {:>14} {:>8} {:>12}", "input", head[0], head[1], head[2], head[3]),
    ];
    for (factor, Indices { first, total }) in found.bars() {
        let (name, of, last) = (short(&factor.path), interval(total), interval(first));
        let (value, alone) = (total.value, first.value);
        lines.push(format!("{name:<33} {value:>10.2} {of:>14} {alone:>8.2} {last:>12}"));
    }
    lines.push(
        "total: share of the variance that is left if all others are fixed; alone: share\n\
         that goes if this one is fixed"
            .to_owned(),
    );
    let counts =
        [(found.without_window, "fail at the nominal start"), (found.diverged, "diverge there")];
    let zeros = counts.iter().filter(|(count, _)| *count > 0);
    let zeros: Vec<String> =
        zeros.map(|(count, what)| format!("{count} {what} and count as 0")).collect();
    let zeros = zeros.iter().map(|zero| format!("; {zero}")).collect::<String>();
    lines.push(format!("{} windows simulated{zeros}", found.evaluations));
    lines.join("\n") + "\n"
}

/// A key without the path that all keys of a task have in common.
fn short(key: &str) -> &str {
    let key = key.strip_prefix("task.").unwrap_or(key);
    key.strip_prefix("strategy.").map_or(key, |rest| rest.strip_prefix("phase.").unwrap_or(rest))
}

/// Left edge of the bars and height of one, pixels.
const LEFT: i32 = 300;
const ROW: i32 = 34;
const WIDTH: u32 = 900;

/// A bar for each input with its interval, most first.
pub fn svg(found: &Found) -> Result<String, ReportError> {
    let height = 110 + ROW as u32 * found.factors.len() as u32;
    sheet("the sensitivity", (WIDTH, height), |area| draw(area, found))
}

fn draw(area: &Area<'_>, found: &Found) -> Drawn {
    let bars = found.bars();
    let largest = bars.iter().map(|(_, of)| of.total.high.max(of.total.value)).fold(1e-9, f64::max);
    let pixels = f64::from(WIDTH as i32 - LEFT - 60) / largest;
    let at = |value: f64| LEFT + (value.max(0.0) * pixels).round() as i32;
    let title = format!("{} of {}: shares of the variance", found.objective, found.task);
    let note = "bar: with all it acts with (total), line: 95 %; dark: alone";
    let style = |size, colour, h| words(size, colour, h, VPos::Center);
    area.draw_text(&title, &style(20, INK, HPos::Left), (20, 24)).map_err(message)?;
    area.draw_text(note, &style(15, MUTED, HPos::Left), (20, 50)).map_err(message)?;
    for (row, (factor, Indices { first, total })) in bars.iter().enumerate() {
        let y = 86 + ROW * row as i32;
        let rectangle = |to: i32, half: i32, style: ShapeStyle| {
            Rectangle::new([(LEFT, y - half), (to, y + half)], style)
        };
        area.draw(&rectangle(at(total.value), 10, BLUE.rgb().mix(0.6).filled()))
            .map_err(message)?;
        area.draw(&rectangle(at(first.value), 5, INK.rgb().mix(0.7).filled())).map_err(message)?;
        let ends = vec![(at(total.low), y), (at(total.high), y)];
        area.draw(&PathElement::new(ends, INK.rgb().stroke_width(2))).map_err(message)?;
        let name =
            format!("{} ({} to {})", short(&factor.path), tick(factor.low), tick(factor.high));
        area.draw_text(&name, &style(13, INK, HPos::Right), (LEFT - 8, y)).map_err(message)?;
        let value = format!("{:.2}", total.value);
        area.draw_text(&value, &style(14, INK, HPos::Left), (at(total.high) + 8, y))
            .map_err(message)?;
    }
    let axis = vec![(LEFT, 66), (LEFT, 80 + ROW * bars.len() as i32 - ROW / 2)];
    area.draw(&PathElement::new(axis, LINES.rgb().stroke_width(1))).map_err(message)
}
