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
    pub session: SessionArguments,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (study, setup) = arguments.open()?;
    session::run(study, &setup, &arguments.session)
}

impl Arguments {
    /// Opens the study to go on with it.
    pub fn open(&self) -> Result<(Study, Setup), Failure> {
        let mut study = Study::resume(&self.dir)?;
        let inputs = study.inputs()?;
        let setup = Setup::from_inputs(&inputs, &study.provenance().engine.name)?;
        study.measure_with(&setup.provenance(), &inputs, self.session.if_changed())?;
        Ok((study, setup))
    }
}
