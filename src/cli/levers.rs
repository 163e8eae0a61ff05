//! `optimize levers`: what would help more than the infill.

use super::words::wrapped;
use super::{Failure, print, print_json};
use crate::session::LeversRequest;
use clap::Args;
use insertion::trial::NEVER;
use report::levers as shown;
use std::path::PathBuf;
use study::write_file;

/// Find out what would help a finger more than its infill: tilt, strokes, grip, friction, robot.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: LeversRequest,
    /// Draw the ranges at both ends of each lever
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let found = arguments.request.run(&NEVER)?;
    if let Some(path) = &arguments.svg {
        write_file(path, &shown::svg(&found))?;
    }
    if arguments.json {
        print_json(&shown::json(&found))
    } else {
        print(&wrapped(&shown::text(&found)))
    }
}
