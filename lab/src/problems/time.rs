//! Processor time of a suggestion of the Gaussian process.

use super::functions::Function;
use ask_tell::{Grid, Observation, OptimizerKind, build};
use std::time::Instant;

/// Timed evaluations.
const TIMED: std::ops::RangeInclusive<usize> = 191..=210;

/// Processor time of `ask` and `tell` together near 200 evaluations.
#[derive(Debug, Clone, PartialEq)]
pub struct SuggestionTime {
    pub levels: Vec<u32>,
    pub mean_ms: f64,
    pub worst_ms: f64,
}

/// Times on grids of the printable space, on finer ones and on six axes.
pub fn suggestion_times() -> Vec<SuggestionTime> {
    let grids = [vec![21, 41], vec![101, 101], vec![141, 141], vec![1001; 2], vec![1001; 6]];
    grids.into_iter().map(suggestion_time).collect()
}

fn suggestion_time(levels: Vec<u32>) -> SuggestionTime {
    let origin = Instant::now();
    let grid = Grid::new(levels.clone());
    let mut optimizer = build(OptimizerKind::Gp, grid.clone(), 0);
    let mut times_ms = Vec::new();
    for evaluation in 1..=*TIMED.end() {
        let begun = seconds(origin);
        let points = optimizer.ask(1);
        let asked = seconds(origin) - begun;
        let value = |unit: &[f64]| match unit.len() {
            2 => -Function::Branin.value(unit) / 30.0,
            _ => -Function::Hartmann6.value(unit),
        };
        let observe = |point| {
            let value = value(&grid.unit(&point));
            Observation::new(point, Some(value))
        };
        let told: Vec<Observation> = points.into_iter().map(observe).collect();
        let begun = seconds(origin);
        optimizer.tell(&told);
        if TIMED.contains(&evaluation) {
            times_ms.push((asked + seconds(origin) - begun) * 1e3);
        }
    }
    let mean_ms = times_ms.iter().sum::<f64>() / times_ms.len() as f64;
    SuggestionTime { levels, mean_ms, worst_ms: times_ms.into_iter().fold(0.0, f64::max) }
}

/// Processor seconds this process has used, where the system tells (Linux); else wall seconds.
/// Other programs on the machine would show in wall time.
fn seconds(origin: Instant) -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split_whitespace().next().and_then(|n| n.parse::<f64>().ok());
    nanoseconds.map_or_else(|| origin.elapsed().as_secs_f64(), |n| n * 1e-9)
}

/// Markdown table of suggestion times.
pub fn time_markdown(times: &[SuggestionTime]) -> String {
    let row =
        |t: &SuggestionTime| format!("| {:?} | {:.1} | {:.1} |\n", t.levels, t.mean_ms, t.worst_ms);
    let rows: String = times.iter().map(row).collect();
    format!("| levels | mean, ms | worst, ms |\n| --- | --- | --- |\n{rows}")
}
