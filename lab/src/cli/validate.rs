//! `lab validate`: our windows beside the published ones.

use super::{Failure, print, print_json};
use crate::compare::fingers::Windows;
use crate::compare::published::{self as beside, TaskTable};
use clap::{Args, ValueEnum};
use finger_opt::calibration::published::{self, Origin};
use finger_opt::cli::arguments::FingerModelArguments;
use finger_opt::session::{self, DEFAULT_ROBOT, SetupRequest, TaskFile};
use finger_opt::study::write_file;
use input::shipped::TASKS;
use insertion::evaluation::tolerance::Search;
use insertion::robot::Robot;
use insertion::stiffness::Measurement;
use insertion::task::{StartRule, Task};
use insertion::trial::engine::EngineKind;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Which of the measured fingers are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Fingers {
    /// All 11
    All,
    /// Those of lowest, middle and highest compliance stiffness
    Three,
}

impl Fingers {
    /// Their infill and stiffness.
    pub fn designs(self) -> Vec<Measurement> {
        match self {
            Fingers::All => published::designs(),
            Fingers::Three => published::three(published::designs()),
        }
    }
}

/// Compare our tolerance windows with the published ones.
///
/// Measures the windows of all published designs, with their measured stiffness, step by
/// step as the paper does, and writes validation.csv, validation_summary.csv and accuracy.md.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Task: ket8, ket12, rj45, usb, all, or the path of a task file of such a name
    #[arg(long, value_name = "NAME", default_value = "all")]
    task: String,
    /// Measured fingers
    #[arg(long, value_enum, default_value = "all")]
    fingers: Fingers,
    /// Robot: see `optimize tasks`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    robot: String,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    engine: EngineKind,
    /// Look every 0.5 mm and bisect: a third of the trials, but blind to gaps narrower than that
    #[arg(long)]
    strides: bool,
    #[command(flatten)]
    finger_model: FingerModelArguments,
    /// What becomes of the nominal start, in place of what the task file says
    #[arg(long, value_enum)]
    start: Option<StartRule>,
    /// Folder that tables are written to
    #[arg(long, value_name = "DIR", default_value = "results/validation")]
    out: PathBuf,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut tasks = tasks(&arguments.task)?;
    for task in &mut tasks {
        task.strategy.rule = arguments.start.unwrap_or(task.strategy.rule);
    }
    let robot = session::robot(&arguments.robot)?;
    let search = if arguments.strides { Search::Strides } else { Search::Walk };
    let tables = arguments.measure(&tasks, &robot, search)?;
    write(&arguments.out, &tables)?;
    let engine = arguments.engine.name();
    if arguments.json {
        return print_json(&json!({
            "robot": robot.name,
            "engine": engine,
            "search": search_name(search),
            "tasks": beside::json(&tables),
            "agreement_with_bench": beside::accuracy_json(&tables),
        }));
    }
    let texts: Vec<String> = tables.iter().map(beside::text).collect();
    print(&format!(
        "robot {}, engine {engine}, {}; y: compliance, z: assembly, of one finger\n\
         ends: failure class (1 lost early, 2 missed, 3 jammed, 4 lost)\n\n\
         {}\nmean error of the range, mm; rank correlation (Spearman); failures matched, %\n\
         starts: nominal ones that insert; bench: the published experiments\n\n{}\n\
         tables are in {}\n",
        robot.name,
        search_name(search),
        texts.join("\n"),
        // The units stand above.
        beside::accuracy(&tables).replace(" mm", "").replace(" %", "").replace(" of ", "/"),
        arguments.out.display(),
    ))
}

/// What tables call a search.
pub fn search_name(search: Search) -> &'static str {
    match search {
        Search::Walk => "walk",
        Search::Strides => "strides",
    }
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
    fn measure(
        &self,
        tasks: &[Task],
        robot: &Robot,
        search: Search,
    ) -> Result<Vec<TaskTable>, Failure> {
        let fingers = self.finger_model.of(SetupRequest::default()).fingers()?;
        let engine = self.engine;
        let windows = Windows { fingers: &fingers, robot, engine, search };
        windows.measure(tasks, &self.fingers.designs()).map_err(Failure::input)
    }
}

/// A task of which something is published.
fn task(name: &str) -> Result<Task, Failure> {
    let TaskFile { source, task } = session::read_task(name)?;
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
    write_file(&out.join("validation.csv"), &beside::csv(tables))?;
    write_file(&out.join("validation_summary.csv"), &beside::summary_csv(tables))?;
    write_file(&out.join("accuracy.md"), &beside::accuracy(tables))?;
    Ok(())
}
