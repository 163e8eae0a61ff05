//! `lab windows`: windows by exhaustive search, and how far they are from those at a fine step.

use super::validate::tasks;
use super::{Failure, print};
use crate::compare::Subject;
use crate::compare::windows::{self, Row};
use clap::Args;
use finger_opt::setup::files;
use finger_opt::setup::request::DEFAULT_ROBOT;
use finray::printed::PrintedFinger;
use input::shipped::{self, FINGERS, SPACES};
use insertion::robot::Robot;
use insertion::space::Space;
use insertion::stiffness::Measurement;
use insertion::surrogate;
use insertion::task::Task;
use insertion::trial::engine::EngineKind;
use insertion::trial::run::EngineRig;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use study::write_file;

/// Step of the reference, as a share of the production step: 0.125 ms of 0.5.
const FINE: f64 = 0.25;

/// Judge a change of the engine by windows at a fine step
///
/// Writes the windows of the measured fingers, or of random ones, by exhaustive search; or, with
/// --compare, counts the ends of one such file that are off by more than 0.1 mm from those of
/// another. An end is firm if the reference has it within 0.1 mm in six repeats with friction,
/// start and step varied; at a gap if a start within 0.4 mm of the first that fails inserts again.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("what").required(true))]
pub struct Arguments {
    /// File that windows are written to
    #[arg(long, value_name = "FILE.csv", group = "what")]
    out: Option<PathBuf>,
    /// Reference, and windows that are compared with it
    #[arg(long, value_names = ["REFERENCE.csv", "FILE.csv"], num_args = 2, group = "what")]
    compare: Vec<PathBuf>,
    /// Task: ket8, ket12, rj45, usb or all
    #[arg(long, value_name = "NAME", default_value = "all")]
    task: String,
    /// Random fingers of the space `infill` for each task, in place of the 11 measured
    #[arg(long, value_name = "N")]
    random: Option<u32>,
    /// Quarter of the step, and each end judged by repeats
    #[arg(long)]
    reference: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let [reference, file] = &arguments.compare[..] {
        return print(&windows::compare(&read(reference)?, &read(file)?));
    }
    let robot = files::robot(DEFAULT_ROBOT)?;
    let mut rows = Vec::new();
    for task in tasks(&arguments.task)? {
        let designs = designs(&task.name, arguments.random)?;
        rows.extend(arguments.measure(task, &robot, &designs)?);
    }
    // One of the two is required.
    arguments.out.iter().try_for_each(|out| Ok(write_file(out, &windows::csv(&rows))?))
}

impl Arguments {
    fn measure(
        &self,
        task: Task,
        robot: &Robot,
        designs: &[Measurement],
    ) -> Result<Vec<Row>, Failure> {
        let rig = |factor: f64| {
            let engine = EngineKind::Direct.build(factor);
            EngineRig::new(task.clone(), robot, engine).map_err(Failure::input)
        };
        let (rig, coarser) = match self.reference {
            true => (rig(FINE)?, Some(rig(2.0 * FINE)?)),
            false => (rig(1.0)?, None),
        };
        let row = |design: &Measurement| {
            let subject = Subject::new(&task.name, &task.finger, *design);
            windows::measure(&subject, &rig, coarser.as_ref().map(|rig| rig as _))
        };
        Ok(designs.par_iter().map(row).collect())
    }
}

fn designs(task: &str, random: Option<u32>) -> Result<Vec<Measurement>, Failure> {
    let designs = insertion::stiffness::designs();
    let Some(count) = random else { return Ok(designs) };
    let [finger, ..] = FINGERS else { return Ok(designs) };
    let printed = PrintedFinger::parse(finger.text, finger.file).map_err(Failure::input)?;
    let model = surrogate::fit(&designs, &printed).map_err(Failure::input)?;
    let space = shipped::resolve("space", SPACES, "infill").map_err(Failure::input)?;
    let space = Space::parse(&space.text, &space.file).map_err(Failure::input)?;
    Ok(windows::random(task, &space, &model, count))
}

fn read(file: &Path) -> Result<Vec<Row>, Failure> {
    let path = file.display().to_string();
    let source = shipped::resolve("windows", &[], &path).map_err(Failure::input)?;
    windows::parse(&source.text, &source.file).map_err(Failure::input)
}
