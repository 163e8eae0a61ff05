//! `optimize tasks`: lists shipped files.

use crate::command;
use crate::context::Context;
use crate::failure::Failure;
use input::shipped::{SPACES, Shipped, TASKS, UNCERTAINTIES};
use serde::Serialize;
use std::fmt;

/// List tasks, spaces and uncertainties
#[derive(Debug, clap::Args)]
#[command(display_order = 51, after_help = "Example: optimize tasks --json")]
pub struct Request {}

/// Shipped files by kind.
#[derive(Serialize)]
pub struct Listed {
    tasks: Vec<File>,
    spaces: Vec<File>,
    uncertainties: Vec<File>,
}

#[derive(Serialize)]
struct File {
    name: &'static str,
    description: String,
}

impl command::Request for Request {
    type Response = Listed;

    fn run(&self, _context: &Context<'_>) -> Result<Listed, Failure> {
        let (tasks, spaces) = (described(TASKS)?, described(SPACES)?);
        Ok(Listed { tasks, spaces, uncertainties: described(UNCERTAINTIES)? })
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

impl command::Response for Listed {}

impl fmt::Display for Listed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kinds = ["tasks", "spaces", "uncertainties"];
        for (kind, files) in kinds.iter().zip([&self.tasks, &self.spaces, &self.uncertainties]) {
            writeln!(f, "{kind}")?;
            for File { name, description } in files {
                writeln!(f, "  {name:<10} {description}")?;
            }
        }
        Ok(())
    }
}
