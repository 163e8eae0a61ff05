//! `optimize report`: writes the tables and plots of a study again.

use crate::studies::report::{PAGE, rewrite};
use crate::{Context, Failure, Output, command};
use serde::Serialize;
use std::path::PathBuf;

/// Write the tables and plots of a study again
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: optimize report results/usb-gp-seed0")]
pub struct Request {
    /// Folder of the study
    pub dir: PathBuf,
}

/// Report page that was written.
#[derive(Serialize)]
pub struct Written {
    page: PathBuf,
    evaluations: usize,
}

impl command::Request for Request {
    fn run(&self, _context: &Context<'_>) -> Result<Output, Failure> {
        let record = rewrite(&self.dir)?;
        let (page, evaluations) = (self.dir.join(PAGE), record.evaluations.len());
        let text = format!("wrote the report of {evaluations} evaluations: {}\n", page.display());
        Ok(Output::new(text, Written { page, evaluations }))
    }
}
