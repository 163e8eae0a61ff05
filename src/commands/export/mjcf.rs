//! `optimize export mjcf`: writes the scene of a trial as MJCF.

use crate::{Context, Failure, FingerRequest, Output, SetupRequest, command};
use contact::mjcf::{self, MjcfSettings};
use insertion::Scenario;
use insertion::trial::cell;
use serde::Serialize;
use std::path::PathBuf;
use study::write_file;

/// Export the scene of a trial as MJCF, the model format of MuJoCo and its viewer
///
/// The part stands at its pick-up place and the jaws are open. In the viewer the
/// sliders move the robot's command and close the jaws. MuJoCo is not needed for the export.
#[derive(Debug, clap::Args)]
#[command(
    mut_arg("engine", |engine| engine.hide(true)),
    after_help = "Example: optimize export mjcf --task usb --density 20 --direction 10 --out scene.xml"
)]
pub struct Request {
    /// One task, robot and finger model.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// The finger.
    #[command(flatten)]
    pub finger: FingerRequest,
    /// File to write
    #[arg(long, value_name = "FILE.xml")]
    pub out: PathBuf,
}

/// Exported file, and the task of its scene.
#[derive(Serialize)]
pub struct ExportedScene {
    out: PathBuf,
    task: String,
}

impl command::Request for Request {
    fn run(&self, _context: &Context<'_>) -> Result<Output, Failure> {
        let setup = self.setup.setup()?;
        let Scenario { task, finger, robot, .. } = self.finger.choose(&setup)?.scenario;
        let mounted = robot.mount(task.turn, task.strategy.tilt).map_err(Failure::input)?;
        let scene = cell::build(&task, &mounted, &finger).scene;
        let remedy = match scene.first_patch() {
            Some(_) => "give finger_plug_torsion_mm in mm",
            None => "choose --robot servo or --robot rigid",
        };
        let scene = mjcf::write(&scene, &task.name, &MjcfSettings::default())
            .map_err(|error| Failure::usage(format!("{error}; {remedy}")))?;
        write_file(&self.out, &scene)?;
        let (out, task) = (self.out.clone(), task.name);
        let text = format!("wrote the scene of {task} to {} for MuJoCo\n", out.display());
        Ok(Output::new(text, ExportedScene { out, task }))
    }
}
