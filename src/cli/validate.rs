//! `optimize validate`: our windows beside the published ones.

use super::setup::{self, DEFAULT_ENGINE, DEFAULT_ROBOT, EngineKind};
use super::{Failure, print, print_json};
use crate::evaluation::Window;
use crate::evaluation::tolerance::{self, Search};
use crate::input::published::{self, Origin};
use crate::input::robot::Robot;
use crate::input::shipped::TASKS;
use crate::input::task::Task;
use crate::report::validation;
use crate::study::write_file;
use crate::verify::agreement::{self, TaskTable};
use clap::Args;
use rayon::prelude::*;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Compare our tolerance windows with the published ones.
///
/// Measures the windows of all published designs, with their measured stiffness,
/// and writes validation.csv, validation_summary.csv and figures.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Task: ket8, ket12, rj45, usb, all, or the path of a task file of such a name
    #[arg(long, value_name = "NAME", default_value = "all")]
    task: String,
    /// Robot: see `optimize tasks`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    robot: String,
    /// Contact engine
    #[arg(long, value_enum, default_value = DEFAULT_ENGINE)]
    engine: EngineKind,
    /// Go step by step to the first failure: sees gaps narrower than 0.5 mm, three times the trials
    #[arg(long)]
    walk: bool,
    /// Folder that tables and figures are written to
    #[arg(long, value_name = "DIR", default_value = "results/validation")]
    out: PathBuf,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let tasks = tasks(&arguments.task)?;
    let robot = setup::robot(&arguments.robot)?;
    let tables = arguments.measure(&tasks, &robot)?;
    write(&arguments.out, &tables)?;
    if arguments.json {
        return print_json(&json!({
            "robot": robot.name,
            "engine": arguments.engine.name(),
            "tasks": agreement::json(&tables),
        }));
    }
    let (engine, out) = (arguments.engine.name(), arguments.out.display());
    let texts: Vec<String> = tables.iter().map(agreement::text).collect();
    print(&format!(
        "robot {}, engine {engine}; ends: failure class (1 lost early, 2 missed, 3 jammed, 4 lost)\n\n\
         {}\ntables and figures are in {out}\n",
        robot.name,
        texts.join("\n"),
    ))
}

/// The task of that name, or `all` of them; only such of which something is published.
pub fn tasks(name: &str) -> Result<Vec<Task>, Failure> {
    let names = match name {
        "all" => TASKS.iter().map(|shipped| shipped.name).collect(),
        name => vec![name],
    };
    names.into_iter().map(task).collect()
}

impl Arguments {
    /// All windows, in parallel over tasks and designs; collected in order, so
    /// the number of threads changes nothing.
    fn measure(&self, tasks: &[Task], robot: &Robot) -> Result<Vec<TaskTable>, Failure> {
        let designs = published::designs();
        let search = if self.walk { Search::Walk } else { Search::Strides };
        let rig = |task| setup::rig(self.engine, task, robot).map_err(Failure::input);
        let rigs: Vec<_> = tasks.iter().map(rig).collect::<Result<_, _>>()?;
        let pairs: Vec<_> = tasks
            .iter()
            .zip(&rigs)
            .flat_map(|(task, rig)| designs.iter().map(move |design| (task, rig, design)))
            .collect();
        let windows: Vec<Window> = pairs
            .into_par_iter()
            .map(|(task, rig, design)| {
                tolerance::evaluate(&**rig, &agreement::finger(&task.finger, design), search).window
            })
            .collect();
        let of_tasks = windows.chunks(designs.len().max(1));
        let table = |(task, windows): (&Task, &[Window])| {
            TaskTable::new(&task.name, designs.iter().copied().zip(windows.iter().cloned()))
        };
        Ok(tasks.iter().zip(of_tasks).map(table).collect())
    }
}

/// A task of which something is published.
fn task(name: &str) -> Result<Task, Failure> {
    let source = setup::find("task", TASKS, name)?;
    let task = Task::parse(&source.text, &source.file).map_err(Failure::input)?;
    if published::of_task(&task.name, Origin::Simulation).is_empty() {
        let names: Vec<&str> = TASKS.iter().map(|shipped| shipped.name).collect();
        return Err(Failure::usage(format!(
            "{}: nothing is published of the task `{}`; there are {}",
            source.file,
            task.name,
            names.join(", ")
        )));
    }
    Ok(task)
}

fn write(out: &Path, tables: &[TaskTable]) -> Result<(), Failure> {
    write_file(&out.join("validation.csv"), &agreement::csv(tables))?;
    write_file(&out.join("validation_summary.csv"), &agreement::summary_csv(tables))?;
    let figures = validation::figures(tables)
        .map_err(|error| Failure::running(format!("cannot draw the figures: {error}")))?;
    for (name, svg) in figures {
        write_file(&out.join(name), &svg)?;
    }
    Ok(())
}
