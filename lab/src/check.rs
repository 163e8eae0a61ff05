//! `lab check`: compares an engine with closed-form solutions, or its windows with those at half the step or by another
//! search.

use crate::compare::{Setting, TaskSettings, pairs, tasks};
use crate::{Failure, print};
use clap::Args;
use contact::Engine;
use finger_opt::setup::files;
use finger_opt::setup::request::DEFAULT_ROBOT;
use insertion::stiffness::{designs, representative_designs};
use insertion::trial::run::EngineRig;
use insertion::{EngineKind, OffsetStep, Robot, Search, Task};
use std::sync::Arc;

/// Largest accepted shift of a window's end at half the time step, in grid steps of 0.1 mm.
const ALLOWED_STEPS: OffsetStep = 1;

/// Compare the contact engine with analytic results.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    engine: EngineKind,
    /// Compare tolerance windows with those at half the time step instead
    #[arg(long, group = "windows")]
    convergence: bool,
    /// Compare the windows of the exhaustive search with those of the coarse-to-fine search instead
    #[arg(long, group = "windows")]
    searches: bool,
    /// Tasks of the windows: ket8, ket12, rj45, usb or all
    #[arg(long, value_name = "NAME", default_value = "all", requires = "windows")]
    task: String,
    /// All 11 measured fingers, not only those of lowest, middle and highest compliance stiffness
    #[arg(long, requires = "windows")]
    all_fingers: bool,
    /// Robot of the windows
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT, requires = "windows")]
    robot: String,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let engine = arguments.engine;
    if !engine.simulates() {
        let name = engine.name();
        return Err(Failure::usage(format!("--engine {name} does not simulate contacts")));
    }
    if arguments.convergence || arguments.searches {
        return arguments.windows();
    }
    let mut rows = analytic_checks::run(&|factor| engine.build(factor));
    rows.extend(analytic_checks::slab::forms(&engine.name()));
    let failed = rows.iter().filter(|row| !row.passed).count();
    print(&analytic_checks::table(&rows))?;
    verdict("checks", failed, rows.len())
}

impl Arguments {
    fn windows(&self) -> Result<(), Failure> {
        let robot = files::robot(&self.robot)?;
        let settings = if self.convergence { steps } else { searches };
        let engine = || self.engine.build(1.0);
        let tasks = tasks(&self.task)?.into_iter().map(|task| settings(task, &robot, engine()));
        let tasks = tasks.collect::<Result<Vec<_>, _>>()?;
        let allowed = if self.convergence { ALLOWED_STEPS } else { 0 };
        let fingers = if self.all_fingers { designs() } else { representative_designs() };
        let found = pairs::simulate(&tasks, &fingers);
        let failed = found.iter().filter(|pair| !pair.agrees(allowed)).count();
        print(&pairs::text(&found, Some(allowed)))?;
        verdict("windows", failed, found.len())
    }
}

/// Returns the settings of a task with the engine's time step and with half of it.
fn steps(task: Task, robot: &Robot, engine: Box<dyn Engine>) -> Result<TaskSettings, Failure> {
    let half = engine.with_half_step();
    let setting = |name: &str, engine| {
        let rig = EngineRig::new(task.clone(), robot, engine)?;
        Ok::<_, Failure>(Setting { name: name.into(), rig: Arc::new(rig), search: Search::Strides })
    };
    let settings = [setting("production", engine)?, setting("half the step", half)?];
    Ok(TaskSettings { task, settings })
}

/// Returns the settings of a task with the exhaustive and with the coarse-to-fine search.
fn searches(task: Task, robot: &Robot, engine: Box<dyn Engine>) -> Result<TaskSettings, Failure> {
    let rig = Arc::new(EngineRig::new(task.clone(), robot, engine)?);
    let setting = |(name, search)| Setting { name: String::from(name), rig: rig.clone(), search };
    let settings = [("walk", Search::Walk), ("strides", Search::Strides)].map(setting);
    Ok(TaskSettings { task, settings })
}

fn verdict(checks: &str, failed: usize, all: usize) -> Result<(), Failure> {
    match failed {
        0 => Ok(()),
        failed => Err(Failure::running(format!("{failed} of {all} {checks} failed"))),
    }
}
