//! `optimize tasks`: what is shipped.

use super::{Failure, print, print_json};
use clap::Args;
use input::InputError;
use input::shipped::{ROBOTS, SPACES, Shipped, TASKS, UNCERTAINTIES};
use insertion::evaluation::uncertainty::Uncertainty;
use insertion::robot::Robot;
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

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    list(arguments.json)
}

/// Prints what is shipped.
pub fn list(json: bool) -> Result<(), Failure> {
    let mut text = String::new();
    let mut lists = serde_json::Map::new();
    for (kind, entries) in lists_of_shipped()? {
        text.push_str(&format!("{kind}\n"));
        let mut list = Vec::new();
        for (name, description) in entries {
            text.push_str(&format!("  {name:<10} {description}\n"));
            list.push(json!({"name": name, "description": description}));
        }
        lists.insert(kind.to_owned(), list.into());
    }
    if json { print_json(&lists.into()) } else { print(&text) }
}

type Entries = Vec<(&'static str, String)>;

fn lists_of_shipped() -> Result<[(&'static str, Entries); 4], Failure> {
    let task = |file: &Shipped| Ok::<_, InputError>(Task::parse(file.text, file.file)?.description);
    let space =
        |file: &Shipped| Ok::<_, InputError>(Space::parse(file.text, file.file)?.description);
    let robot =
        |file: &Shipped| Ok::<_, InputError>(Robot::parse(file.text, file.file)?.description);
    let uncertainty =
        |file: &Shipped| Ok::<_, InputError>(Uncertainty::parse(file.text, file.file)?.description);
    Ok([
        ("tasks", described(TASKS, task).map_err(Failure::input)?),
        ("spaces", described(SPACES, space).map_err(Failure::input)?),
        ("robots", described(ROBOTS, robot).map_err(Failure::input)?),
        ("uncertainties", described(UNCERTAINTIES, uncertainty).map_err(Failure::input)?),
    ])
}

fn described<E>(
    shipped: &[Shipped],
    description: impl Fn(&Shipped) -> Result<String, E>,
) -> Result<Entries, E> {
    shipped.iter().map(|file| Ok((file.name, description(file)?))).collect()
}
