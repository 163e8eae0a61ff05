//! `optimize export mjcf`: the scene of a trial.

use crate::cli::{Failure, print};
use crate::session::SceneRequest;
use clap::Args;
use std::path::PathBuf;
use study::write_file;

/// The scene of a trial as MJCF, the model format of MuJoCo and its viewer
///
/// The part stands at its pick-up place and the jaws are open. In the viewer the
/// sliders move the robot's command and close the jaws. Needs no MuJoCo.
#[derive(Debug, Args)]
#[command(mut_arg("engine", |engine| engine.hide(true)))]
pub struct Arguments {
    #[command(flatten)]
    request: SceneRequest,
    /// File to write
    #[arg(long, value_name = "FILE.xml")]
    out: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (task, text) = arguments.request.mjcf()?;
    write_file(&arguments.out, &text)?;
    print(&format!("wrote {}: the scene of {task}, for MuJoCo\n", arguments.out.display()))
}
