//! `optimize tasks`: what is shipped.

use super::{Failure, print, print_json};
use clap::Args;
use input::shipped::{SPACES, TASKS, UNCERTAINTIES};
use serde_json::{Value, json};

/// List what is shipped.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Print the list as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (json, text) = listed()?;
    if arguments.json { print_json(&json) } else { print(&text) }
}

/// Output of `--json`, and without.
pub fn listed() -> Result<(Value, String), Failure> {
    let mut text = String::new();
    let mut lists = serde_json::Map::new();
    for (kind, files) in [("tasks", TASKS), ("spaces", SPACES), ("uncertainties", UNCERTAINTIES)] {
        text.push_str(&format!("{kind}\n"));
        let mut list = Vec::new();
        for file in files {
            let fields: toml::Table = input::read(file.text, file.file).map_err(Failure::input)?;
            let (name, description) = (file.name, fields.get("description"));
            let words = description.and_then(toml::Value::as_str).unwrap_or_default();
            text.push_str(&format!("  {name:<10} {words}\n"));
            list.push(json!({"name": name, "description": words}));
        }
        lists.insert(kind.to_owned(), list.into());
    }
    Ok((lists.into(), text))
}
