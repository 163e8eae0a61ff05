//! `lab identify`: identification of a cell, tried on cells that are hidden in the other engine.

use super::{Failure, print};
use crate::identified::truth::{self, Rows};
use crate::identified::{HiddenCell, logs, tried};
use clap::{Args, Subcommand};
use finger_opt::setup::Setup;
use finger_opt::setup::request::{SetupRequest, TaskSource};
use finger_opt::terminal::say;
use insertion::space::Design;
use insertion::stiffness::Measurement;
use insertion::trial::engine::EngineKind;
use rayon::prelude::*;
use report::identify;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use study::write_file;

/// Tasks of the cells, in turn.
const TASKS: &str = "usb,ket8";

/// Try identification on cells that are hidden in the other engine, MuJoCo
#[derive(Debug, Args)]
#[command(arg_required_else_help = true)]
pub struct Arguments {
    #[command(subcommand)]
    stage: Stage,
}

#[derive(Debug, Subcommand)]
enum Stage {
    Truth(Truth),
    Logs(Cells),
    Try(Cells),
}

/// Measure the windows of the published fingers in hidden cells, in MuJoCo and in our engine
///
/// Friction, flange, preload, torsion of the pad and edges are drawn from priors/bench.toml; odd
/// cells do usb, even ones ket8. A row is written as it is measured; rows that are there stay.
#[derive(Debug, Args)]
struct Truth {
    /// Cells, first and last
    #[arg(long, value_name = "A..B", value_parser = cells)]
    cells: RangeInclusive<u64>,
    /// Table that is written, or gone on with
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,
}

/// Write the logs of attempts in hidden cells; or identify the cells from them
#[derive(Debug, Args)]
struct Cells {
    /// Cells, first and last
    #[arg(long, value_name = "A..B", value_parser = cells)]
    cells: RangeInclusive<u64>,
    /// Table that `truth` has written
    #[arg(long, value_name = "FILE.csv")]
    truth: PathBuf,
    /// Folder of the logs: one in it for each cell
    #[arg(long, value_name = "DIR")]
    logs: PathBuf,
}

impl Cells {
    fn rows(&self) -> Result<Rows, Failure> {
        truth::parse(&std::fs::read_to_string(&self.truth).map_err(running)?)
    }

    fn folder(&self, cell: u64) -> PathBuf {
        self.logs.join(cell.to_string())
    }

    fn write(&self) -> Result<(), Failure> {
        let (engine, setup, rows) = (mujoco()?, setup()?, self.rows()?);
        let all: Vec<u64> = self.cells.clone().collect();
        all.par_iter().try_for_each(|&number| {
            let cell = HiddenCell::draw(&setup.evaluator, number)?;
            let known = |design: &Design| truth::known(&rows, number, design);
            logs::write(&cell, known, engine, &self.folder(number))?;
            say(&format!("cell {number}: logged"));
            Ok(())
        })
    }

    fn identify(&self) -> Result<(), Failure> {
        let (setup, rows) = (setup()?, self.rows()?);
        let mut all = Vec::new();
        for number in self.cells.clone() {
            let cell = HiddenCell::draw(&setup.evaluator, number)?;
            let known = |design: &Design| truth::known(&rows, number, design);
            let (one, done) = tried::identify(&cell, known, &self.folder(number))?;
            say(&format!("cell {number}\n{}", identify::text(&done)));
            let file = self.folder(number).join("identified.json");
            write_file(&file, &identify::json(&done).to_string())?;
            all.push(one);
        }
        print(&tried::table(&all))
    }
}

fn mujoco() -> Result<EngineKind, Failure> {
    EngineKind::from_name("mujoco")
        .ok_or_else(|| Failure::usage("build lab with --features mujoco"))
}

fn setup() -> Result<Setup, Failure> {
    SetupRequest { tasks: TaskSource::list(TASKS), ..SetupRequest::default() }.setup()
}

fn cells(text: &str) -> Result<RangeInclusive<u64>, String> {
    let range = text.split_once("..").and_then(|(first, last)| {
        let [first, last] = [first, last].map(|number| number.parse::<u64>().ok());
        Some(first?..=last?).filter(|range| *range.start() > 0 && !range.is_empty())
    });
    range.ok_or_else(|| "must be two numbers from 1 up, as 1..20".to_owned())
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.stage {
        Stage::Truth(truth) => truth.run(),
        Stage::Logs(cells) => cells.write(),
        Stage::Try(cells) => cells.identify(),
    }
}

impl Truth {
    fn run(&self) -> Result<(), Failure> {
        let (engine, setup) = (mujoco()?, setup()?);
        let mut rows = match self.out.exists() {
            true => truth::parse(&std::fs::read_to_string(&self.out).map_err(running)?)?,
            false => Rows::new(),
        };
        write(&self.out, &rows)?;
        let file = OpenOptions::new().append(true).open(&self.out).map_err(running)?;
        let file = Mutex::new(file);
        for number in self.cells.clone() {
            let cell = HiddenCell::draw(&setup.evaluator, number)?;
            let missing = |finger: &Measurement| !rows.contains_key(&(number, finger.design));
            let fingers: Vec<_> =
                insertion::stiffness::designs().into_iter().filter(missing).collect();
            let row = |finger: &Measurement| {
                let row = truth::measure(&cell, finger, engine)?;
                append(&file, &row)?;
                Ok(((number, finger.design), row))
            };
            let measured = fingers.par_iter().map(row).collect::<Result<Vec<_>, Failure>>()?;
            say(&format!("cell {number}: {} fingers measured", measured.len()));
            rows.extend(measured);
        }
        // In order, whichever finger was ready first.
        write(&self.out, &rows)?;
        print(&truth::summary(&rows))
    }
}

fn write(out: &Path, rows: &Rows) -> Result<(), Failure> {
    let lines = std::iter::once(truth::header()).chain(rows.values().cloned());
    Ok(write_file(out, &lines.map(|line| line + "\n").collect::<String>())?)
}

fn append(file: &Mutex<File>, row: &str) -> Result<(), Failure> {
    let mut file = file.lock().map_err(|_| Failure::running("another finger failed"))?;
    file.write_all(format!("{row}\n").as_bytes()).and_then(|()| file.sync_data()).map_err(running)
}

fn running(error: std::io::Error) -> Failure {
    Failure::Run(error.into())
}
