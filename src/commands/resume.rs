//! `optimize resume`: continues a study.

use crate::studies::open::OpenStudy;
use crate::studies::output;
use crate::{Context, Failure, Output, RunRequest, Setup, command};
use std::path::PathBuf;
use study::Study;

/// Continue a study after an interruption or a crash
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: optimize resume results/usb-gp-seed0")]
pub struct Request {
    /// Folder of the study
    pub dir: PathBuf,
    /// Options of the run.
    #[command(flatten)]
    pub run: RunRequest,
    /// Also print all numbers on which the answer is based
    #[arg(long, conflicts_with = "json")]
    pub verbose: bool,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        output::run(self.open()?, context, self.verbose)
    }
}

impl Request {
    /// Opens the study to continue it.
    pub fn open(&self) -> Result<OpenStudy, Failure> {
        let mut study = Study::resume(&self.dir)?;
        let no_confirm = study.config.conclusion.no_confirm || self.run.no_confirm;
        let inputs = study.inputs()?;
        let mut setup = Setup::from_inputs(&inputs, &study.provenance().engine.name)?;
        let given = study.config.conclusion.measurements.clone();
        if let Some((measured, file)) = setup.measured.as_mut().zip(given) {
            measured.file = file;
        }
        setup.task_files.clone_from(&study.config.conclusion.task_files);
        setup.robot_file.clone_from(&study.config.conclusion.robot_file);
        study.set_provenance(&setup.provenance(), &inputs, self.run.accept_changed)?;
        OpenStudy::new(study, setup, RunRequest { no_confirm, ..self.run.clone() })
    }
}
