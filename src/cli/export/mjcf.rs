//! `optimize export mjcf`: the scene of a trial.

use crate::cli::setup::{Setup, SetupArguments};
use crate::cli::specimen::FingerArguments;
use crate::cli::{Failure, print};
use crate::study::write_file;
use clap::Args;
use contact::mjcf::{self, MjcfSettings};
use insertion::evaluation::evaluator::Specimen;
use insertion::trial::cell;
use std::path::PathBuf;

/// The scene of a trial as MJCF, the model format of MuJoCo and its viewer
///
/// The part stands at its pick-up place and the jaws are open. In the viewer the
/// sliders move the robot's command and close the jaws. Needs no MuJoCo.
#[derive(Debug, Args)]
#[command(mut_arg("engine", |engine| engine.hide(true)))]
pub struct Arguments {
    #[command(flatten)]
    setup: SetupArguments,
    #[command(flatten)]
    finger: FingerArguments,
    /// File to write
    #[arg(long, value_name = "FILE.xml")]
    out: PathBuf,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let setup = Setup::from_arguments(&arguments.setup)?;
    let chosen = arguments.finger.choose(&setup)?;
    let Specimen { task, finger, .. } = &chosen.specimen;
    let mounted =
        setup.evaluator.robot.mount(task.turn, task.strategy.tilt).map_err(Failure::input)?;
    let scene = cell::build(task, &mounted, finger).scene;
    let instead = match scene.patched() {
        Some(_) => "give finger_plug_torsion_mm in mm",
        None => "--robot servo and --robot rigid need none of it",
    };
    let text = mjcf::write(&scene, &task.name, &MjcfSettings::default())
        .map_err(|error| Failure::usage(format!("{error}; {instead}")))?;
    write_file(&arguments.out, &text)?;
    print(&format!("wrote {}: the scene of {}, for MuJoCo\n", arguments.out.display(), task.name))
}
