//! `lab validate`: compares our tolerance windows with the published ones.

use crate::compare::published as beside;
use crate::{Failure, print};
use calibration::published::{self, SIMULATION};
use clap::{Args, ValueEnum};
use finger_opt::setup::files;
use finger_opt::setup::request::{DEFAULT_ROBOT, FingerModelRequest};
use finger_opt::setup::task::{TaskFile, read_task};
use input::shipped::TASKS;
use insertion::evaluation::tolerance::Search;
use insertion::stiffness::Measurement;
use insertion::task::Task;
use insertion::trial::engine::EngineKind;
use std::path::PathBuf;
use study::write_file;

/// Selection of measured fingers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Fingers {
    /// All 11
    All,
    /// Those of lowest, middle and highest compliance stiffness
    Three,
}

impl Fingers {
    pub fn designs(self) -> Vec<Measurement> {
        match self {
            Fingers::All => insertion::stiffness::designs(),
            Fingers::Three => insertion::stiffness::representative_designs(),
        }
    }
}

/// Compare our tolerance windows with the published ones.
///
/// Measures the windows of all published designs, with their measured stiffness, by exhaustive
/// search as in the paper, and writes validation.csv and accuracy.md.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Task: ket8, ket12, rj45, usb, all, or the path of a task file of such a name
    #[arg(long, value_name = "NAME", default_value = "all")]
    task: String,
    /// Measured fingers
    #[arg(long, value_enum, default_value = "all")]
    fingers: Fingers,
    /// Robot: see `optimize robots`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    robot: String,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    engine: EngineKind,
    /// Coarse-to-fine search, every 0.5 mm and bisection: a third of the trials, but it misses narrower gaps
    #[arg(long)]
    strides: bool,
    #[command(flatten)]
    finger_model: FingerModelRequest,
    /// Folder of the tables
    #[arg(long, value_name = "DIR", default_value = "results/validation")]
    out: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let tasks = tasks(&arguments.task)?;
    let robot = files::robot(&arguments.robot)?;
    let search = if arguments.strides { Search::Strides } else { Search::Walk };
    let fingers = arguments.finger_model.fingers()?;
    let designs = arguments.fingers.designs();
    let tables = beside::windows(&fingers, &robot, arguments.engine, search, &tasks, &designs);
    let tables = tables.map_err(Failure::input)?;
    let accuracy = beside::accuracy(&tables);
    write_file(&arguments.out.join("validation.csv"), &beside::csv(&tables))?;
    write_file(&arguments.out.join("accuracy.md"), &accuracy)?;
    print(&format!(
        "robot {}, engine {}, {}\n\
         mean error of the range, mm; rank correlation (Spearman); failures matched, %\n\
         starts: nominal ones that insert; bench: the published experiments\n\n{}\n\
         tables are in {}\n",
        robot.name,
        arguments.engine.name(),
        search_name(search),
        // The second line already names the units.
        accuracy.replace(" mm", "").replace(" %", "").replace(" of ", "/"),
        arguments.out.display(),
    ))
}

pub fn search_name(search: Search) -> &'static str {
    match search {
        Search::Walk => "walk",
        Search::Strides => "strides",
    }
}

/// Reads the task with this name, or for `all` every shipped task.
///
/// # Errors
/// If a task has no published windows or cannot be read.
pub fn tasks(name: &str) -> Result<Vec<Task>, Failure> {
    let names = match name {
        "all" => TASKS.iter().map(|shipped| shipped.name).collect(),
        name => vec![name],
    };
    names.into_iter().map(task).collect()
}

fn task(name: &str) -> Result<Task, Failure> {
    let TaskFile { source, task } = read_task(name)?;
    if published::of_task(&task.name, SIMULATION).is_empty() {
        let names = TASKS.iter().map(|shipped| shipped.name).collect::<Vec<_>>().join(", ");
        let (file, task) = (source.file, task.name);
        return Err(Failure::usage(format!(
            "{file}: task `{task}` has no published windows; available: {names}"
        )));
    }
    Ok(task)
}
