//! `optimize measure check`: checks a measurement file.

use crate::command::{self, Output};
use crate::context::Context;
use crate::failure::Failure;
use crate::setup::measured;
use crate::setup::task::read_task;
use serde::Serialize;
use serde_json::json;
use std::collections::BTreeMap;

/// Check a measurement file: implausible units, windows without the start, duplicate lines, unknown tasks
#[derive(Debug, clap::Args)]
#[command(display_order = 2, after_help = "Example: optimize measure check bench.csv")]
pub struct Request {
    /// The file, or `published` for the shipped one
    #[arg(value_name = "FILE")]
    pub file: String,
    /// File of your own task that is not named in a comment line; may be given several times
    #[arg(long, value_name = "FILE.toml")]
    pub task: Vec<String>,
    /// List the lines
    #[arg(long, hide = true)]
    pub rows: bool,
}

/// Numbers of lines of one task.
#[derive(Debug, Default, Serialize)]
struct TaskLines {
    task: String,
    lines: usize,
    ranges: usize,
    /// Number of lower bounds of a range.
    bounds: usize,
    /// Number of measured windows.
    repeats: u32,
}

impl command::Request for Request {
    fn run(&self, _context: &Context<'_>) -> Result<Output, Failure> {
        let own = self.task.iter().map(|name| Ok(read_task(name)?.task.name));
        let own = own.collect::<Result<Vec<_>, Failure>>()?;
        let own: Vec<&str> = own.iter().map(String::as_str).collect();
        let found = measured::read(&self.file, &own)?;
        let mut tasks: BTreeMap<&str, TaskLines> = BTreeMap::new();
        for line in &found {
            let known = tasks.entry(&line.task).or_default();
            known.task.clone_from(&line.task);
            known.lines += 1;
            known.repeats += line.repeats;
            match line.extent() {
                Some((_, false)) => known.ranges += 1,
                Some((_, true)) => known.bounds += 1,
                None => (),
            }
        }
        let tasks: Vec<TaskLines> = tasks.into_values().collect();
        let line = |TaskLines { task, lines, ranges, bounds, .. }: &TaskLines| {
            let rest = lines - ranges - bounds;
            format!(
                "{task:<8} {}, {}, {rest:>3} not measurable\n",
                input::counted(*ranges, "range"),
                input::counted(*bounds, "lower bound")
            )
        };
        let (file, lines) = (&self.file, found.len());
        let text = tasks.iter().map(line).collect::<String>()
            + &format!("{file}: {}, no problems found\n", input::counted(lines, "line"));
        let mut value = json!({"file": file, "lines": lines, "tasks": tasks});
        if self.rows {
            // By the columns of the file; null where a column is empty.
            value["rows"] = json!(found);
        }
        Ok(Output::new(text, value))
    }
}
