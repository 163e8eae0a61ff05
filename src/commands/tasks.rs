//! `optimize tasks`: lists the shipped tasks, spaces and uncertainties.

use crate::{Context, Failure, Output, TaskFile, command, layout};
use connector::seat::clearance;
use input::shipped::{COMMERCIAL, SPACES, Shipped, Source, TASKS, UNCERTAINTIES};
use input::units::MM;
use serde_json::{Value, json};

/// List tasks, spaces and uncertainties
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: optimize tasks --json")]
pub struct Request {}

/// Entry of the list as JSON and as a line of text.
type Entry = (Value, String);

impl command::Request for Request {
    fn run(&self, _context: &Context<'_>) -> Result<Output, Failure> {
        let (tasks, task_lines): (Vec<Value>, String) =
            TASKS.iter().chain(COMMERCIAL).map(task).collect::<Result<_, Failure>>()?;
        let (spaces, space_lines): (Vec<Value>, String) =
            SPACES.iter().map(entry).collect::<Result<_, Failure>>()?;
        let (uncertainties, uncertainty_lines): (Vec<Value>, String) =
            UNCERTAINTIES.iter().map(entry).collect::<Result<_, Failure>>()?;
        let text = format!(
            "tasks, with their clearance in x and y\n{task_lines}spaces\n{space_lines}\
             uncertainties\n{uncertainty_lines}"
        );
        let value = json!({"tasks": tasks, "spaces": spaces, "uncertainties": uncertainties});
        Ok(Output::new(layout::wrapped(&text), value))
    }
}

/// Returns the entry of a space or of uncertainties: name and description.
fn entry(Shipped { name, file, text, .. }: &Shipped) -> Result<Entry, Failure> {
    let fields: toml::Table = input::read(text, file)?;
    let description = fields.get("description").and_then(toml::Value::as_str).unwrap_or_default();
    let line = format!("  {name:<10} {description}\n");
    Ok((json!({"name": name, "description": description}), line))
}

/// Returns the entry of a task: name, description, and clearance of the seated plug, mm.
fn task(Shipped { name, file, text, .. }: &Shipped) -> Result<Entry, Failure> {
    let task = TaskFile::parse(Source { file: (*file).to_owned(), text: (*text).to_owned() })?.task;
    // Two decimals, the accuracy of the computed clearance.
    let [x, y] = clearance(&task).map(|length| (length / MM * 100.0).round() / 100.0);
    let description = task.description;
    let line = format!("  {name:<10} {x:.2}, {y:.2} mm  {description}\n");
    let json = json!({
        "name": name,
        "description": description,
        "clearance_x_mm": x,
        "clearance_y_mm": y,
    });
    Ok((json, line))
}
