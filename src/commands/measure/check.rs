//! `optimize measure check`: checks a measurement file.

use crate::setup::measured::{self, BenchFileRequest};
use crate::{Context, Failure, Output, command, read_task};
use calibration::experiments::Experiment;
use serde_json::{Value, json};

/// Check a measurement file: implausible units, windows without the start, duplicate lines, unknown tasks
#[derive(Debug, clap::Args)]
#[command(
    mut_arg("file", |file| file.help("The file, or `published` for the shipped one")),
    after_help = "Example: optimize measure check bench.csv"
)]
pub struct Request {
    /// The file.
    #[command(flatten)]
    pub file: BenchFileRequest,
    /// File of your own task that is not named in a comment line; may be given several times
    #[arg(long, value_name = "FILE.toml")]
    pub task: Vec<String>,
    /// List the lines
    #[arg(long, hide = true)]
    pub rows: bool,
}

impl command::Request for Request {
    fn run(&self, _context: &Context<'_>) -> Result<Output, Failure> {
        let own = self.task.iter().map(|name| Ok(read_task(name)?.task.name));
        let own = own.collect::<Result<Vec<_>, Failure>>()?;
        let own: Vec<&str> = own.iter().map(String::as_str).collect();
        let file = self.file.name();
        let found = measured::read(file, &own)?;
        let of_task = |of: &[Experiment]| {
            let count = |least: Option<bool>| {
                of.iter().filter(|line| line.extent().map(|(_, least)| least) == least).count()
            };
            let [ranges, bounds, rest] = [Some(false), Some(true), None].map(count);
            let task = &of[0].task;
            let own = input::counted(ranges, "range");
            let least = input::counted(bounds, "lower bound");
            let text = format!("{task:<8} {own}, {least}, {rest:>3} not measurable\n");
            let counts = json!({
                "task": task,
                "lines": of.len(),
                "ranges": ranges,
                // Lines with one end only, a lower bound of the range.
                "bounds": bounds,
                // Number of measured windows; a line can contain the mean of several.
                "repeats": of.iter().map(|line| line.repeats).sum::<u32>(),
            });
            (counts, text)
        };
        // The lines are sorted by task.
        let tasks = found.chunk_by(|a, b| a.task == b.task).map(of_task);
        let (tasks, text): (Vec<Value>, String) = tasks.unzip();
        let lines = found.len();
        let text =
            text + &format!("{file}: {}, no problems found\n", input::counted(lines, "line"));
        let mut value = json!({"file": file, "lines": lines, "tasks": tasks});
        if self.rows {
            // The keys are the columns of the file; null for an empty cell.
            value["rows"] = json!(found);
        }
        Ok(Output::new(text, value))
    }
}
