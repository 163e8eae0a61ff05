//! `optimize config`: prints the settings in effect in this folder.

use crate::layout::lines;
use crate::project::{PROJECT_FILE, Project, Settings, exists};
use crate::setup::files::robot;
use crate::setup::request::{DEFAULT_ROBOT, DEFAULT_SPACE};
use crate::setup::task::read_space;
use crate::{Context, Failure, Output, command, read_task};
use serde_json::json;

/// Print the settings of finger-opt.toml in this folder or above
///
/// The file sets task, robot, cell, measurements, space and threads for all commands in its folder and below. Options
/// take precedence over it; --no-config ignores it. Seed and budget belong to one study and cannot be set there.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: optimize config --json")]
pub struct Request {}

impl command::Request for Request {
    fn run(&self, _context: &Context<'_>) -> Result<Output, Failure> {
        let found = Project::current()?;
        found.iter().try_for_each(check)?;
        let (file, settings) = found.map(|found| (found.file, found.settings)).unzip();
        let settings = settings.unwrap_or_default();
        let mut set = json!(settings);
        if let Some(set) = set.as_object_mut() {
            set.retain(|_, value| !value.is_null());
        }
        Ok(Output::new(text(file.as_deref(), settings), json!({"file": file, "settings": set})))
    }
}

/// Checks the names of tasks, robot, cell and space. The measurements may not exist yet.
fn check(project: &Project) -> Result<(), Failure> {
    let Settings { task, robot: of_robot, space, .. } = &project.settings;
    let tasks = task.iter().flat_map(|tasks| tasks.split(','));
    let tasks = tasks.map(|name| ("task", read_task(name).err()));
    let robot = of_robot.iter().map(|name| ("robot", robot(name).err()));
    let space = space.iter().map(|name| ("space", read_space(name).err()));
    let mut all = tasks.chain(robot).chain(space);
    let problem = all.find_map(|(key, problem)| Some(project.fault(key, problem?)));
    problem.map_or_else(|| project.check_cell(), Err)
}

fn text(file: Option<&str>, settings: Settings) -> String {
    let Settings { task, robot, cell, measurements, space, threads } = settings;
    let none = format!("no {PROJECT_FILE} in this folder or above");
    let from = file.unwrap_or_default();
    let threads = threads.map(|count| count.to_string());
    let contained = if cell.is_some() { "; not used: the cell contains one" } else { "" };
    let there = measurements.as_deref().is_none_or(exists);
    let missing = if there { "" } else { "; no such file yet" };
    let rows = [
        ("task", task, "none", ""),
        ("robot", robot, DEFAULT_ROBOT, contained),
        ("cell", cell, "none", ""),
        ("measurements", measurements, "none", missing),
        ("space", space, DEFAULT_SPACE, ""),
        ("threads", threads, "one per processor", ""),
    ];
    let rows = rows.into_iter().map(|(key, set, default, remark)| {
        let text = match set {
            Some(value) => format!("{value:<24} ({from}{remark})"),
            None => format!("{default:<24} (default)"),
        };
        (key.to_owned(), text)
    });
    lines(std::iter::once(("file".to_owned(), file.map_or(none, str::to_owned))).chain(rows))
}
