//! `optimize report DIR`: makes the tables and plots of a study again.

use super::{Failure, print};
use clap::Args;
use finger_opt::study::{StudyRecord, write_evaluations_csv};
use std::path::PathBuf;

/// Report on a study.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder of the study
    dir: PathBuf,
}

/// Runs the command. SEAM: the plots and the HTML report go beside the table.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let record = StudyRecord::load(&arguments.dir)?;
    write_evaluations_csv(&arguments.dir, &record)?;
    let count = record.evaluations.len();
    print(&format!("wrote the report of {count} evaluations to {}\n", arguments.dir.display()))
}
