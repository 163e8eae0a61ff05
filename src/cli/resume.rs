//! `optimize resume DIR`: continues a study.

use super::Failure;
use super::session::{self, SessionArguments};
use super::setup::Setup;
use crate::study::{Study, StudyConfig, StudyError, read_inputs};
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
    let study = Study::resume(&arguments.dir)?;
    let inputs = read_inputs(study.dir(), &study.config)?;
    let setup = Setup::from_inputs(&inputs, &study.config.engine)?;
    let now = StudyConfig { versions: setup.engine.versions(), ..study.config.clone() };
    if let Some(differences) = study.config.differences(&now) {
        let dir = arguments.dir.clone();
        return Err(StudyError::Different { dir, differences }.into());
    }
    session::run(study, &setup, &arguments.session)
}
