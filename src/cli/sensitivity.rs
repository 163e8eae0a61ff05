//! `optimize sensitivity`: which unknown matters for the window.

use super::{Failure, print, print_json};
use crate::session::SensitivityRequest;
use clap::Args;
use insertion::trial::NEVER;
use report::sensitivity as shown;
use std::path::PathBuf;
use study::write_file;

/// Find out which input matters: of the design, the task and the cell.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: SensitivityRequest,
    /// Write a chart of the shares
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let found = arguments.request.run(&NEVER)?;
    if let Some(path) = &arguments.svg {
        write_file(path, &shown::svg(&found)?)?;
    }
    if arguments.json { print_json(&shown::json(&found)) } else { print(&shown::text(&found)) }
}
