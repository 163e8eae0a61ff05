//! `optimize check`: does the contact engine, as it is set, reproduce known results?

use super::setup::EngineKind;
use super::{Failure, print, print_json};
use clap::Args;
use finger_opt::check;
use finger_opt::engine::rapier::Rapier;

/// Compare the contact engine with analytic results.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Contact engine
    #[arg(long, value_enum, default_value = super::setup::DEFAULT_ENGINE)]
    engine: EngineKind,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let engine = arguments.engine;
    if engine.build(1.0).is_none() {
        let name = engine.name();
        return Err(Failure::usage(format!("--engine {name} simulates no contacts to be checked")));
    }
    // `build` answers alike whatever the step, so the second engine is never needed.
    let make = |factor: f64| engine.build(factor).unwrap_or_else(|| Box::<Rapier>::default());
    let rows = check::run(&make);
    if arguments.json {
        print_json(&check::json(&rows))?;
    } else {
        print(&check::table(&rows))?;
    }
    match rows.iter().filter(|row| !row.passed).count() {
        0 => Ok(()),
        failed => Err(Failure::running(format!("{failed} of {} checks failed", rows.len()))),
    }
}
