//! `optimize tasks`: lists shipped files.

use crate::command::{self, Output};
use crate::context::Context;
use crate::failure::Failure;
use crate::setup::task::TaskFile;
use connector::seat::clearance;
use input::shipped::{COMMERCIAL, SPACES, Shipped, Source, TASKS, UNCERTAINTIES};
use input::units::MM;
use serde::Serialize;

/// List tasks, spaces and uncertainties
#[derive(Debug, clap::Args)]
#[command(display_order = 51, after_help = "Example: optimize tasks --json")]
pub struct Request {}

/// Shipped files by kind.
#[derive(Serialize)]
pub struct ShippedFiles {
    tasks: Vec<TaskEntry>,
    spaces: Vec<FileEntry>,
    uncertainties: Vec<FileEntry>,
}

#[derive(Serialize)]
struct FileEntry {
    name: &'static str,
    description: String,
}

/// Task with its clearance where the plug seats.
#[derive(Serialize)]
struct TaskEntry {
    #[serde(flatten)]
    file: FileEntry,
    clearance_x_mm: f64,
    clearance_y_mm: f64,
}

impl command::Request for Request {
    type Response = ShippedFiles;

    fn run(&self, _context: &Context<'_>) -> Result<Output<ShippedFiles>, Failure> {
        let tasks = TASKS.iter().chain(COMMERCIAL).map(entry).collect::<Result<Vec<_>, _>>()?;
        let [spaces, uncertainties] = [SPACES, UNCERTAINTIES].map(file_entries);
        let value = ShippedFiles { tasks, spaces: spaces?, uncertainties: uncertainties? };
        Ok(Output::new(value.text(), value))
    }
}

/// Reads the descriptions of files.
fn file_entries(files: &[Shipped]) -> Result<Vec<FileEntry>, Failure> {
    let read = |file: &Shipped| {
        let fields: toml::Table = input::read(file.text, file.file).map_err(Failure::input)?;
        let description = fields.get("description").and_then(toml::Value::as_str);
        Ok(FileEntry { name: file.name, description: description.unwrap_or_default().to_owned() })
    };
    files.iter().map(read).collect()
}

/// Reads the description of a task and computes its clearance.
fn entry(file: &Shipped) -> Result<TaskEntry, Failure> {
    let source = Source { file: file.file.to_owned(), text: file.text.to_owned() };
    let task = TaskFile::parse(source)?.task;
    // Two decimals, the accuracy of the seat.
    let rounded_mm = |length: f64| (length / MM * 100.0).round() / 100.0;
    let [clearance_x_mm, clearance_y_mm] = clearance(&task).map(rounded_mm);
    let file = FileEntry { name: file.name, description: task.description };
    Ok(TaskEntry { file, clearance_x_mm, clearance_y_mm })
}

impl ShippedFiles {
    fn text(&self) -> String {
        let task = |TaskEntry { file, clearance_x_mm, clearance_y_mm }: &TaskEntry| {
            let FileEntry { name, description } = file;
            format!("  {name:<10} {clearance_x_mm:.2}, {clearance_y_mm:.2} mm  {description}\n")
        };
        let line = |of: &FileEntry| format!("  {:<10} {}\n", of.name, of.description);
        let lines = |files: &[FileEntry]| files.iter().map(line).collect::<String>();
        format!(
            "tasks, with their clearance in x and y\n{}spaces\n{}uncertainties\n{}",
            self.tasks.iter().map(task).collect::<String>(),
            lines(&self.spaces),
            lines(&self.uncertainties)
        )
    }
}
