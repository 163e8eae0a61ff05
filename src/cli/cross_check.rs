//! `optimize cross-check`: do two engines agree on what goes in?

use super::setup::{self, DEFAULT_ENGINE, DEFAULT_ROBOT, EngineKind};
use super::validate::tasks;
use super::{Failure, print, print_json};
use crate::input::published;
use crate::input::stiffness::Measurement;
use crate::input::task::Task;
use crate::trial::Rig;
use crate::verify::agreement;
use crate::verify::cross_check::{self, Pair, Set};
use clap::Args;

/// Compare the outcomes of the same trials in two contact engines (check T9)
///
/// The softest and the stiffest measured finger on every task, started about both
/// ends of the first engine's window. Exits with 1 if the engines agree on less
/// than 90 % of the trials, or if the windows' ends differ by more than 0.5 mm on
/// average.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Contact engine that is compared
    #[arg(long, value_enum, default_value = DEFAULT_ENGINE)]
    engine: EngineKind,
    /// Contact engine that it is compared with; mujoco if the program was built with it
    #[arg(long, value_enum)]
    against: EngineKind,
    /// Task: ket8, ket12, rj45, usb, all, or the path of a task file of such a name
    #[arg(long, value_name = "NAME", default_value = "all")]
    task: String,
    /// Robot: see `optimize tasks`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    robot: String,
    /// A few trials far from the windows' ends, and no windows of the second engine
    #[arg(long)]
    reduced: bool,
    /// Time one trial of each task in both engines instead, one thread, medians of 5
    #[arg(long, conflicts_with = "reduced")]
    time: bool,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let names = [arguments.engine.name(), arguments.against.name()];
    let tasks = tasks(&arguments.task)?;
    let robot = setup::robot(&arguments.robot)?;
    let rig = |engine, task| setup::rig(engine, task, &robot).map_err(Failure::input);
    let rigs = tasks
        .iter()
        .map(|task| Ok([rig(arguments.engine, task)?, rig(arguments.against, task)?]))
        .collect::<Result<Vec<_>, Failure>>()?;
    let pairs: Vec<Pair> =
        tasks.iter().zip(&rigs).flat_map(|(task, rigs)| pairs(task, rigs)).collect();
    if arguments.time {
        let rows = cross_check::time(&pairs);
        return if arguments.json {
            print_json(&cross_check::time_json(&rows, names))
        } else {
            print(&cross_check::time_text(&rows, names))
        };
    }
    let set = if arguments.reduced { Set::Reduced } else { Set::Full };
    let check = cross_check::run(&pairs, set);
    if arguments.json {
        print_json(&cross_check::json(&check, names))?;
    } else {
        print(&cross_check::text(&check, names))?;
    }
    if check.passed() {
        return Ok(());
    }
    Err(Failure::running(format!("{} and {} do not agree well enough", names[0], names[1])))
}

/// The softest and the stiffest of the measured fingers on a task.
fn pairs<'a>(task: &'a Task, rigs: &'a [Box<dyn Rig>; 2]) -> Vec<Pair<'a>> {
    let designs = published::designs();
    let compliance = |a: &&Measurement, b: &&Measurement| a.compliance.total_cmp(&b.compliance);
    let ends = [designs.iter().min_by(compliance), designs.iter().max_by(compliance)];
    let pair = |design: &Measurement| Pair {
        task: task.name.clone(),
        finger_name: format!("{} %, {} deg", design.density_percent, design.direction_deg),
        finger: agreement::finger(&task.finger, design),
        rigs: rigs.each_ref().map(|rig| &**rig),
    };
    ends.into_iter().flatten().map(pair).collect()
}
