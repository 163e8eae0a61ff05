//! `optimize tasks`: what is shipped.

use super::{Failure, print, print_json};
use clap::Args;
use input::InputError;
use input::shipped::{SPACES, Shipped, TASKS, UNCERTAINTIES};
use insertion::evaluation::uncertainty::Uncertainty;
use insertion::space::Space;
use insertion::task::Task;
use serde_json::json;

/// List what is shipped.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Print the list as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut text = String::new();
    let mut lists = serde_json::Map::new();
    let lists_of = [
        ("tasks", described(TASKS, |file| Ok(Task::parse(file.text, file.file)?.description))),
        ("spaces", described(SPACES, |file| Ok(Space::parse(file.text, file.file)?.description))),
        (
            "uncertainties",
            described(UNCERTAINTIES, |file| {
                Ok(Uncertainty::parse(file.text, file.file)?.description)
            }),
        ),
    ];
    for (kind, entries) in lists_of {
        text.push_str(&format!("{kind}\n"));
        let mut list = Vec::new();
        for (name, description) in entries.map_err(Failure::input)? {
            text.push_str(&format!("  {name:<10} {description}\n"));
            list.push(json!({"name": name, "description": description}));
        }
        lists.insert(kind.to_owned(), list.into());
    }
    if arguments.json { print_json(&lists.into()) } else { print(&text) }
}

fn described(
    shipped: &'static [Shipped],
    description: impl Fn(&Shipped) -> Result<String, InputError>,
) -> Result<Vec<(&'static str, String)>, InputError> {
    shipped.iter().map(|file| Ok((file.name, description(file)?))).collect()
}
