//! The scene of a trial for MuJoCo.

use super::Failure;
use super::finger::FingerRequest;
use super::request::SetupRequest;
use contact::mjcf::{self, MjcfSettings};
use insertion::evaluation::evaluator::Specimen;
use insertion::trial::cell;

/// Which scene to write.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SceneRequest {
    /// Task, robot, finger model; one task.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// The finger.
    #[command(flatten)]
    pub finger: FingerRequest,
}

impl SceneRequest {
    /// Name of the task, and the scene as MJCF.
    pub fn mjcf(&self) -> Result<(String, String), Failure> {
        let setup = self.setup.setup()?;
        let Specimen { task, finger, .. } = self.finger.choose(&setup)?.specimen;
        let robot = &setup.evaluator.robot;
        let mounted = robot.mount(task.turn, task.strategy.tilt).map_err(Failure::input)?;
        let scene = cell::build(&task, &mounted, &finger).scene;
        let instead = match scene.patched() {
            Some(_) => "give finger_plug_torsion_mm in mm",
            None => "--robot servo and --robot rigid need none of it",
        };
        let text = mjcf::write(&scene, &task.name, &MjcfSettings::default())
            .map_err(|error| Failure::usage(format!("{error}; {instead}")))?;
        Ok((task.name, text))
    }
}
