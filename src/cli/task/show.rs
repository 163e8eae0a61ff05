//! `optimize task show`: a shipped task file as it is.

use super::super::{Failure, print};
use crate::session::TaskSource;
use clap::Args;

/// Print a shipped task file
#[derive(Debug, Args)]
pub struct Arguments {
    /// Task: ket8, ket12, rj45, usb
    #[arg(value_name = "NAME")]
    name: String,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    print(&TaskSource::Named(arguments.name.clone()).read()?.text)
}
