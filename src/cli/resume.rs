//! `optimize resume DIR`: continues a study.

use super::Failure;
use super::arguments::RunArguments;
use super::study::to_its_end;
use crate::session::ResumeRequest;
use clap::Args;
use std::path::PathBuf;

/// Continue a study.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder of the study
    dir: PathBuf,
    #[command(flatten)]
    pub run: RunArguments,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    to_its_end(arguments.request().open()?, &arguments.run)
}

impl Arguments {
    /// What is asked for.
    pub fn request(&self) -> ResumeRequest {
        ResumeRequest { dir: self.dir.clone(), run: self.run.request() }
    }
}
