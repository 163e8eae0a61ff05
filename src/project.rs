//! Project file `finger-opt.toml`: defaults of options for the commands that are run in its folder or below.

use crate::Failure;
use crate::setup::run::THREADS;
use clap::Command;
use input::files::shell_word;
use input::shipped::{MEASUREMENTS, Source};
use input::{Place, RequestError};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the file.
pub const PROJECT_FILE: &str = "finger-opt.toml";
/// Option that ignores the file.
pub const NO_CONFIG: &str = "no-config";
/// Options that belong to one study and are not accepted as keys.
const OF_STUDY: [&str; 2] = ["seed", "budget"];

/// Keys of a project file; paths are relative to its folder.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Task, or several separated by commas.
    pub task: Option<String>,
    /// Robot.
    pub robot: Option<String>,
    /// Identified cell.
    pub cell: Option<String>,
    /// Measurements from the bench.
    pub measurements: Option<String>,
    /// Search space.
    pub space: Option<String>,
    /// Threads.
    pub threads: Option<u16>,
}

/// Project file and its contents.
#[derive(Debug, Clone, PartialEq)]
pub struct Project {
    /// Path of the file.
    pub file: String,
    /// Text of the file.
    text: String,
    /// Keys with their values; paths relative to the folder of the file are made relative to the current folder.
    pub settings: Settings,
}

/// Default of an option, from a project file.
#[derive(Debug, Clone, PartialEq)]
pub struct OptionDefault {
    /// Name of the option, or of the positional argument for a measurement file.
    pub option: &'static str,
    /// Value as text.
    pub value: String,
}

impl Project {
    /// Returns the project of the current folder: the project file in it or in the nearest parent folder.
    ///
    /// # Errors
    /// If the file is invalid.
    pub fn current() -> Result<Option<Self>, Failure> {
        let Ok(folder) = std::env::current_dir() else { return Ok(None) };
        let found = folder.ancestors().find(|above| above.join(PROJECT_FILE).is_file());
        let Some(found) = found else { return Ok(None) };
        let beside = if found == folder { Path::new("") } else { found };
        Project::read(beside).map(Some)
    }

    fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(PROJECT_FILE);
        let Source { file, text } = Source::read("project file", &path).map_err(Failure::input)?;
        let table: toml::Table = input::read(&text, &file)?;
        let mut project = Project { file, text, settings: Settings::default() };
        let fault = |(key, value): (&String, _)| Some(project.fault(key, key_problem(key, value)?));
        let mut faults: Vec<Failure> = table.iter().filter_map(fault).collect();
        faults.sort_by_key(|fault| fault.place().line);
        if let Some(first) = faults.first() {
            let text = faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
            return Err(Failure::input(RequestError { place: first.place(), text }));
        }
        project.settings = input::read(&project.text, &project.file)?;
        let Settings { task, robot, cell, measurements, space, .. } = &mut project.settings;
        for value in [task, robot, cell, measurements, space].into_iter().flatten() {
            let each = value.split(',').map(|name| beside(folder, name.trim()));
            *value = each.collect::<Vec<_>>().join(",");
        }
        Ok(project)
    }

    /// Returns the error of the value of a key.
    pub(crate) fn fault(&self, key: &str, problem: impl ToString) -> Failure {
        let sets = |line: &str| line.split_once('=').is_some_and(|(name, _)| name.trim() == key);
        let line = self.text.lines().position(sets).map(|before| before + 1);
        let place = Place { line, ..Place::file(&self.file) };
        Failure::input(place.key(key).fault(problem.to_string()))
    }

    /// Checks that the file of the cell exists, if there is one.
    ///
    /// # Errors
    /// If it does not.
    pub(crate) fn check_cell(&self) -> Result<(), Failure> {
        self.settings.cell.iter().find(|file| !Path::new(file).is_file()).map_or(Ok(()), |file| {
            let made = format!("`optimize identify --out {}` writes a cell", shell_word(file));
            Err(self.fault("cell", format!("{file} does not exist; {made}")))
        })
    }

    /// Returns the defaults for a command; and the options that the file sets and the values that the command does not
    /// use, as text: `sets task usb; cell cell.toml not used: --robot`. `given` returns whether an option is on the
    /// command line, which takes precedence.
    ///
    /// # Errors
    /// If the command uses the cell, and its file does not exist.
    pub fn defaults(
        &self,
        command: &Command,
        given: impl Fn(&str) -> bool,
    ) -> Result<(Vec<OptionDefault>, String), Failure> {
        let Settings { task, robot, cell, measurements, space, threads } = self.settings.clone();
        let mut words = Vec::new();
        let mut unless = |why: Option<String>, key: &str, value: Option<String>| {
            let (Some(value), Some(why)) = (&value, why) else { return value };
            words.push(format!("{key} {value} not used: {why}"));
            None
        };
        let name = command.get_name();
        let takes = |long: &str| command.get_arguments().any(|arg| arg.get_long() == Some(long));
        let file = (["add", "check"].contains(&name) && !takes("svg")).then_some("file");
        // A study with another objective, constraints or several tasks does not use measurements.
        let other = ["objective", "constraint", "aggregate"].into_iter().any(&given);
        let bench = takes("measurements").then_some("measurements").filter(|_| !other);
        let of_bench = file.or(bench).filter(|option| !given(option) && !given("measurements"));
        let measurements = measurements.filter(|_| of_bench.is_some());
        // Only `next` and `measure add` accept a missing file of measurements.
        let there = ["next", "add"].contains(&name) || measurements.iter().all(|file| exists(file));
        let missing = (!there).then(|| "no such file".to_owned());
        let measurements = unless(missing, "measurements", measurements);
        let measured = measurements.is_some() && bench.is_some() || given("measurements");
        // With measurements the cell replaces the priors. `identify` writes the cell and does not read it. A robot on
        // the command line takes precedence.
        let cell_option = if measured && takes("priors") { "priors" } else { "cell" };
        let option = ["cell", "priors"].into_iter().find(|option| given(option));
        let cell = cell.filter(|_| takes(cell_option) && name != "identify" && option.is_none());
        let cell = unless(given("robot").then(|| "--robot".to_owned()), "cell", cell);
        cell.iter().try_for_each(|_| self.check_cell())?;
        let with_robot = cell.as_ref().map(|cell| format!("cell {cell}"));
        let with_robot = with_robot.or(option.map(|option| format!("--{option}")));
        let robot = robot.filter(|_| takes("robot") && !given("robot"));
        let robot = unless(with_robot, "robot", robot);
        let threads = threads.map(|count| count.to_string());
        let options: Vec<_> = [
            (Some("task"), task),
            (Some("robot"), robot),
            (Some(cell_option), cell),
            (of_bench, measurements),
            (Some("space"), space),
            (Some("threads"), threads),
        ]
        .into_iter()
        .filter_map(|(option, value)| Some(OptionDefault { option: option?, value: value? }))
        .filter(|set| (set.option == "file" || takes(set.option)) && !given(set.option))
        .collect();
        let set = options.iter().map(|OptionDefault { option, value }| format!("{option} {value}"));
        if !options.is_empty() {
            words.insert(0, format!("sets {}", set.collect::<Vec<_>>().join(", ")));
        }
        Ok((options, words.join("; ")))
    }
}

/// Returns the problem of a key or its value.
fn key_problem(key: &str, value: &toml::Value) -> Option<String> {
    if OF_STUDY.contains(&key) {
        return Some(format!("belongs to one study; give --{key} on the command line"));
    }
    let alone = toml::Table::from_iter([(key.to_owned(), value.clone())]);
    let (least, most) = (THREADS.start(), THREADS.end());
    match alone.try_into() {
        Err(error) => Some(input::syntax("", "", &error).problem),
        Ok(Settings { threads: Some(count), .. }) if !THREADS.contains(&i64::from(count)) => {
            Some(format!("{count}: must lie between {least} and {most}"))
        }
        Ok(_) => None,
    }
}

/// Returns the path of a file in the folder of the project, or the unchanged name if it is not a path.
fn beside(folder: &Path, name: &str) -> String {
    let path = folder.join(name);
    let is_path = path.is_file() || name.contains(['.', '/']);
    if is_path { path.display().to_string() } else { name.to_owned() }
}

/// Returns whether a file of measurements exists or is shipped.
pub(crate) fn exists(file: &str) -> bool {
    Path::new(file).is_file() || MEASUREMENTS.iter().any(|shipped| shipped.name == file)
}

/// Returns the clap definition with these defaults in the command selected by `path`.
pub fn with_defaults(program: Command, path: &[String], defaults: &[OptionDefault]) -> Command {
    if let [name, below @ ..] = path {
        return program.mut_subcommand(name, |command| with_defaults(command, below, defaults));
    }
    defaults.iter().fold(program, |program, set| {
        let of = |arg: &&clap::Arg| arg.get_long().unwrap_or(arg.get_id().as_str()) == set.option;
        let Some(id) = program.get_arguments().find(of).map(|arg| arg.get_id().clone()) else {
            return program;
        };
        // clap requires a default with a static lifetime.
        let value: &'static str = set.value.clone().leak();
        program.mut_arg(id, |arg| arg.required(false).default_value(value))
    })
}
