//! `optimize tasks`: what is shipped.

use super::placeholder::Head;
use super::{Failure, print, print_json};
use clap::Args;
use finger_opt::shipped::{ROBOTS, SPACES, Shipped, TASKS};
use serde_json::json;

/// List what is shipped.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Print the list as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let kinds = [("tasks", TASKS), ("spaces", SPACES), ("robots", ROBOTS)];
    let mut text = String::new();
    let mut lists = serde_json::Map::new();
    for (kind, shipped) in kinds {
        text.push_str(&format!("{kind}\n"));
        let mut list = Vec::new();
        for (name, description) in described(shipped)? {
            text.push_str(&format!("  {name:<10} {description}\n"));
            list.push(json!({"name": name, "description": description}));
        }
        lists.insert(kind.to_owned(), list.into());
    }
    if arguments.json { print_json(&lists.into()) } else { print(&text) }
}

fn described(shipped: &[Shipped]) -> Result<Vec<(&'static str, String)>, Failure> {
    let head = |file: &Shipped| Head::parse(file.text, file.file).map_err(Failure::usage);
    shipped.iter().map(|file| Ok((file.name, head(file)?.description))).collect()
}
