//! `optimize tasks`: lists shipped files.

use crate::command::{self, Output};
use crate::context::Context;
use crate::failure::Failure;
use input::shipped::{SPACES, Shipped, TASKS, UNCERTAINTIES};
use serde::Serialize;

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
    type Response = Output<Listed>;

    fn run(&self, _context: &Context<'_>) -> Result<Self::Response, Failure> {
        let mut text = String::new();
        let mut listed = |kind, files| {
            let files = described(files)?;
            let line = |File { name, description }: &File| format!("  {name:<10} {description}\n");
            text += &format!("{kind}\n{}", files.iter().map(line).collect::<String>());
            Ok::<_, Failure>(files)
        };
        let value = Listed {
            tasks: listed("tasks", TASKS)?,
            spaces: listed("spaces", SPACES)?,
            uncertainties: listed("uncertainties", UNCERTAINTIES)?,
        };
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
