//! Tests the identification of robot cells: windows and logs of cells with hidden parameter values are simulated in
//! MuJoCo. Each cell is identified from its logs, and compared with the hidden values and with the windows of fingers
//! that were not logged.
//!
//! Writes two tables: `truth.csv` (a line for each finger in a cell: its window in MuJoCo, in the engine `direct`, and
//! in `direct` with the nominal cell) and `cells.csv` (a line for each cell).

mod cell;
mod identified;
mod logs;

use cell::{FingerWindows, HIDDEN, HiddenCell};
use clap::Parser;
use finger_opt::failure::Failure;
use finger_opt::setup::request::{SetupRequest, TaskSource};
use insertion::trial::engine::EngineKind;
use rayon::prelude::*;
use std::path::PathBuf;
use study::write_file;

/// Tasks of the cells, in turn.
const TASKS: &str = "usb,ket8";
/// Names of the three simulations of a window in `truth.csv`.
const SIMULATIONS: [&str; 3] = ["truth", "direct", "nominal"];
/// Columns of each simulation, prefixed with its name. Ends are relative to the task's own start, not to the taught
/// one.
const COLUMNS: [&str; 6] =
    ["start_mm", "negative_mm", "positive_mm", "range_mm", "failure_negative", "failure_positive"];

#[derive(Parser)]
struct Arguments {
    /// Numbers of the first and the last cell, from 1; odd cells have usb, even ones ket8
    #[arg(long, required = true, num_args = 2, value_names = ["FIRST", "LAST"])]
    cells: Vec<u64>,
    /// Folder of the tables
    #[arg(long)]
    out: PathBuf,
    /// Folder of the logs: a folder in it for each cell
    #[arg(long)]
    logs: PathBuf,
}

fn main() -> Result<(), Failure> {
    let Arguments { cells, out, logs } = Arguments::parse();
    let engine = EngineKind::from_name("mujoco");
    let engine = engine.ok_or_else(|| Failure::usage("build lab with --features mujoco"))?;
    let setup = SetupRequest { tasks: TaskSource::list(TASKS), ..SetupRequest::default() };
    let evaluator = setup.setup()?.evaluator;
    let (mut truth, mut found) = (truth_header(), identified::header());
    for number in cells[0]..=cells[1] {
        let cell = HiddenCell::draw(&evaluator, number)?;
        let fingers = insertion::stiffness::designs();
        let windows =
            fingers.par_iter().map(|finger| FingerWindows::simulate(&cell, finger, engine));
        let windows = windows.collect::<Result<Vec<_>, Failure>>()?;
        windows.iter().for_each(|finger| truth += &finger.line(&cell));
        let folder = logs.join(number.to_string());
        logs::write(&cell, &windows, engine, &folder)?;
        found += &identified::line(&cell, &windows, &folder)?;
        write_file(&out.join("truth.csv"), &truth)?;
        write_file(&out.join("cells.csv"), &found)?;
        eprintln!("cell {number}: {} fingers", windows.len());
    }
    Ok(())
}

fn truth_header() -> String {
    let hidden = HIDDEN.map(|(_, column)| column).join(",");
    let of = |name| COLUMNS.map(|column| format!("{name}_{column}")).join(",");
    let windows = SIMULATIONS.map(of).join(",");
    format!(
        "cell,design,task,draws,{hidden},infill_density_percent,infill_direction_deg,{windows},truth_taught_again,\
         truth_elapsed_s\n"
    )
}
