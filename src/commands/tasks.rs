//! `optimize tasks`: lists shipped files.

use crate::command::{self, Output};
use crate::context::Context;
use crate::failure::Failure;
use crate::setup::task::TaskFile;
use connector::seat::clearance;
use input::shipped::{COMMERCIAL, SPACES, Shipped, Source, TASKS, UNCERTAINTIES};
use input::units::MM;
use serde::Serialize;
use std::fmt;

/// List tasks, spaces and uncertainties
#[derive(Debug, clap::Args)]
#[command(display_order = 51, after_help = "Example: optimize tasks --json")]
pub struct Request {}

/// Shipped files by kind.
#[derive(Serialize)]
pub struct Listed {
    tasks: Vec<TaskListed>,
    spaces: Vec<File>,
    uncertainties: Vec<File>,
}

#[derive(Serialize)]
struct File {
    name: &'static str,
    description: String,
}

/// Task with its clearance where the plug seats.
#[derive(Serialize)]
struct TaskListed {
    #[serde(flatten)]
    file: File,
    clearance_x_mm: f64,
    clearance_y_mm: f64,
}

impl command::Request for Request {
    type Response = Output<Listed>;

    fn run(&self, _context: &Context<'_>) -> Result<Self::Response, Failure> {
        let tasks = TASKS.iter().chain(COMMERCIAL).map(listed).collect::<Result<Vec<_>, _>>()?;
        let [spaces, uncertainties] = [SPACES, UNCERTAINTIES].map(described);
        let value = Listed { tasks, spaces: spaces?, uncertainties: uncertainties? };
        let text = value.to_string();
        Ok(Output { value, text, picture: None })
    }
}

fn described(files: &[Shipped]) -> Result<Vec<File>, Failure> {
    let described = |file: &Shipped| {
        let fields: toml::Table = input::read(file.text, file.file).map_err(Failure::input)?;
        let description = fields.get("description").and_then(toml::Value::as_str);
        Ok(File { name: file.name, description: description.unwrap_or_default().to_owned() })
    };
    files.iter().map(described).collect()
}

fn listed(file: &Shipped) -> Result<TaskListed, Failure> {
    let source = Source { file: file.file.to_owned(), text: file.text.to_owned() };
    let task = TaskFile::parse(source)?.task;
    let [clearance_x_mm, clearance_y_mm] = clearance(&task).map(|play| round(play / MM));
    let file = File { name: file.name, description: task.description };
    Ok(TaskListed { file, clearance_x_mm, clearance_y_mm })
}

/// Rounds a length to two digits, the accuracy of the seat.
fn round(length_mm: f64) -> f64 {
    (length_mm * 100.0).round() / 100.0
}

impl fmt::Display for Listed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = |of: &File| format!("  {:<10} {}\n", of.name, of.description);
        writeln!(f, "tasks, with their clearance in x and y")?;
        for TaskListed { file, clearance_x_mm, clearance_y_mm } in &self.tasks {
            let File { name, description } = file;
            writeln!(f, "  {name:<10} {clearance_x_mm:.2}, {clearance_y_mm:.2} mm  {description}")?;
        }
        let lines = |files: &[File]| files.iter().map(line).collect::<String>();
        write!(f, "spaces\n{}uncertainties\n{}", lines(&self.spaces), lines(&self.uncertainties))
    }
}
