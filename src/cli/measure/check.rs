//! `optimize measure check`.

use crate::cli::{Failure, print, print_json};
use crate::session::{read_measurements, read_task};
use clap::Args;
use serde_json::json;
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

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let own = arguments.task.iter().map(|name| Ok(read_task(name)?.task.name));
    let own = own.collect::<Result<Vec<_>, Failure>>()?;
    let own: Vec<&str> = own.iter().map(String::as_str).collect();
    let found = read_measurements(&arguments.file, &own)?;
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
