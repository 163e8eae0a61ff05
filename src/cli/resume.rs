//! `optimize resume DIR`: continues a study.

use super::Failure;
use super::session::{self, SessionArguments};
use super::setup::Setup;
use crate::study::Study;
use clap::Args;
use std::path::PathBuf;

/// Continue a study.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder of the study
    dir: PathBuf,
    #[command(flatten)]
    session: SessionArguments,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut study = Study::resume(&arguments.dir)?;
    let inputs = study.inputs()?;
    let setup = Setup::from_inputs(&inputs, &study.provenance().engine.name)?;
    study.measure_with(&setup.provenance(), &inputs, arguments.session.if_changed())?;
    session::run(study, &setup, &arguments.session)
}
