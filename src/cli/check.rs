//! `optimize check`: does the contact engine, as it is set, reproduce known results,
//! and do the windows depend on how finely it cuts time?

use super::setup::{self, DEFAULT_ENGINE, DEFAULT_ROBOT, EngineKind};
use super::{Failure, print, print_json, validate};
use crate::input::published;
use crate::physics::Engine;
use crate::physics::rapier::Rapier;
use crate::verify::analytic::{self, convergence};
use clap::Args;

/// Compare the contact engine with analytic results.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Contact engine
    #[arg(long, value_enum, default_value = DEFAULT_ENGINE)]
    engine: EngineKind,
    /// Compare tolerance windows with finer ones instead: three fingers on each task
    #[arg(long)]
    convergence: bool,
    /// Tasks of the convergence: ket8, ket12, rj45, usb or all
    #[arg(long, value_name = "NAME", default_value = "all", requires = "convergence")]
    task: String,
    /// Robot of the convergence
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT, requires = "convergence")]
    robot: String,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let engine = arguments.engine;
    if !engine.simulates() {
        let name = engine.name();
        return Err(Failure::usage(format!("--engine {name} simulates no contacts to be checked")));
    }
    // `build` answers alike whatever the step, so the second engine is never needed.
    let make =
        |factor: f64| engine.build(factor).engine().unwrap_or_else(|| Box::<Rapier>::default());
    if arguments.convergence {
        return arguments.converge(&|| make(1.0));
    }
    let rows = analytic::run(&make);
    let failed = rows.iter().filter(|row| !row.passed).count();
    arguments.show(analytic::table(&rows), &analytic::json(&rows))?;
    verdict("checks", failed, rows.len())
}

impl Arguments {
    fn converge(&self, make: &(dyn Fn() -> Box<dyn Engine> + Sync)) -> Result<(), Failure> {
        let tasks = validate::tasks(&self.task)?;
        let robot = setup::robot(&self.robot)?;
        let designs = convergence::three(published::designs());
        let rows = convergence::measure(&tasks, &designs, &robot, make).map_err(Failure::input)?;
        let failed = rows.iter().filter(|row| !row.passed()).count();
        self.show(convergence::table(&rows), &convergence::json(&rows))?;
        verdict("windows", failed, rows.len())
    }

    fn show(&self, table: String, json: &serde_json::Value) -> Result<(), Failure> {
        if self.json { print_json(json) } else { print(&table) }
    }
}

fn verdict(what: &str, failed: usize, all: usize) -> Result<(), Failure> {
    match failed {
        0 => Ok(()),
        failed => Err(Failure::running(format!("{failed} of {all} {what} failed"))),
    }
}
