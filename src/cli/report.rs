//! `optimize report DIR`: makes the tables and plots of a study again.

use super::{Failure, print, say};
use crate::session::{PAGE, rewrite};
use clap::Args;
use std::path::PathBuf;

/// Report on a study.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder of the study
    dir: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let record = rewrite(&arguments.dir)?;
    record.remarks().iter().for_each(|remark| say(&format!("warning: {remark}")));
    let count = record.evaluations.len();
    let page = arguments.dir.join(PAGE);
    print(&format!("wrote the report of {count} evaluations: {}\n", page.display()))
}
