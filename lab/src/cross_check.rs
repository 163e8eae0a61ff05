//! `lab cross-check`: agreement of two engines on the outcomes of trials.

use crate::compare::{Setting, TaskSettings, engines, tasks};
use crate::{Failure, print};
use clap::Args;
use finger_opt::setup::files;
use finger_opt::setup::request::DEFAULT_ROBOT;
use insertion::stiffness::designs_by_rank;
use insertion::{EngineKind, FingerSource, Search, Task};

/// Compare the outcomes of the same trials in two contact engines (check T9)
///
/// The softest and the stiffest measured finger on every task, started about both ends of the first
/// engine's window. Exits with 1 if the engines agree on less than 90 % of the trials, or if the
/// windows' ends differ by more than 0.5 mm on average.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Contact engine that is compared
    #[arg(long, value_enum, default_value_t)]
    engine: EngineKind,
    /// Contact engine that it is compared with; mujoco if the program was built with it
    #[arg(long, value_enum)]
    against: EngineKind,
    /// Task: ket8, ket12, rj45, usb, all, or the path of a task file of such a name
    #[arg(long, value_name = "NAME", default_value = "all")]
    task: String,
    /// A few trials far from the windows' ends, and no windows of the second engine
    #[arg(long)]
    reduced: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let kinds = [arguments.engine, arguments.against];
    let names = kinds.map(EngineKind::name);
    let names = names.each_ref().map(String::as_str);
    let robot = files::robot(DEFAULT_ROBOT)?;
    let settings = |task: Task| {
        let setting = |engine: EngineKind| {
            let rig = engine.rig(&task, &robot, &FingerSource::Paper.example(&task), 1.0)?.into();
            Ok::<_, Failure>(Setting { name: engine.name(), rig, search: Search::Strides })
        };
        let [first, second] = kinds.map(setting);
        Ok(TaskSettings { settings: [first?, second?], task })
    };
    let tasks = tasks(&arguments.task)?.into_iter().map(settings);
    let tasks = tasks.collect::<Result<Vec<_>, Failure>>()?;
    let check = engines::run(&tasks, &designs_by_rank([0, 10]), arguments.reduced);
    print(&engines::text(&check, names))?;
    match check.passed() {
        true => Ok(()),
        false => Err(Failure::running(format!("{} do not agree well enough", names.join(" and ")))),
    }
}
