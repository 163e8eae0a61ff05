//! `optimize measure check`.

use crate::cli::terminal::merge;
use crate::cli::{Failure, print, print_json};
use crate::session::{read_measurements, read_task};
use calibration::experiments::Experiment;
use clap::Args;
use insertion::outcome::FailureClass;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Check a measurement file: units that look wrong, windows without the start, lines given
/// twice, unknown tasks
#[derive(Debug, Args)]
pub struct Arguments {
    /// The file; `published` is the one shipped
    #[arg(value_name = "FILE")]
    file: String,
    /// A task of your own that its lines name without a comment line; may be given several times
    #[arg(long, value_name = "FILE.toml")]
    task: Vec<String>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Default)]
struct Known {
    lines: usize,
    ranges: usize,
    bounds: usize,
    /// Insertion windows measured, over all lines.
    repeats: u32,
}

/// The lines of a file with tasks of one's own.
pub fn read(file: &str, tasks: &[String]) -> Result<Vec<Experiment>, Failure> {
    let own = tasks.iter().map(|name| Ok(read_task(name)?.task.name));
    let own = own.collect::<Result<Vec<_>, Failure>>()?;
    let own: Vec<&str> = own.iter().map(String::as_str).collect();
    read_measurements(file, &own)
}

/// The lines by the columns of the file; null where a column is empty.
pub fn json(lines: &[Experiment]) -> Value {
    let line = |line: &Experiment| {
        let ends = line.failures.map(|failure| failure.map(FailureClass::number));
        let mut fields = json!({
            "line": line.line,
            "task": line.task,
            "negative_mm": line.negative_mm,
            "positive_mm": line.positive_mm,
            "range_mm": line.range_mm(),
            "failure_negative": ends[0],
            "failure_positive": ends[1],
            "repeats": line.repeats,
            "peak_force_n": line.peak_force_n,
            "date": line.date,
            "note": line.note,
        });
        merge(&mut fields, json!(line.design));
        fields
    };
    lines.iter().map(line).collect()
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let found = read(&arguments.file, &arguments.task)?;
    let mut tasks: BTreeMap<&str, Known> = BTreeMap::new();
    for line in &found {
        let known = tasks.entry(&line.task).or_default();
        known.lines += 1;
        known.repeats += line.repeats;
        match line.extent() {
            Some((_, false)) => known.ranges += 1,
            Some((_, true)) => known.bounds += 1,
            None => (),
        }
    }
    if arguments.json {
        return print_json(&json!({
            "file": arguments.file,
            "lines": found.len(),
            "tasks": tasks.iter().map(|(task, known)| json!({
                "task": task,
                "lines": known.lines,
                "ranges": known.ranges,
                "bounds": known.bounds,
                "repeats": known.repeats,
            })).collect::<Vec<_>>(),
        }));
    }
    let line = |(task, known): (&&str, &Known)| {
        let rest = known.lines - known.ranges - known.bounds;
        format!(
            "{task:<8} {:>3} ranges, {:>3} ranges known from below, {rest:>3} not measurable\n",
            known.ranges, known.bounds
        )
    };
    let lines: String = tasks.iter().map(line).collect();
    let counted = super::lines(&found);
    print(&format!("{lines}{}: {counted}, nothing looks wrong\n", arguments.file))
}
