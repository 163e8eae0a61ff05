//! `optimize task show`: prints a shipped task file.

use crate::command::{self, Text};
use crate::context::Context;
use crate::failure::Failure;
use crate::setup::request::TaskSource;

/// Print a shipped task file
#[derive(Debug, clap::Args)]
#[command(display_order = 2, after_help = "Example: optimize task show usb > mine.toml")]
pub struct Request {
    /// Task: ket8, ket12, rj45, usb
    #[arg(value_name = "NAME")]
    pub name: String,
}

impl command::Request for Request {
    type Response = Text;
    const JSON: bool = false;

    fn run(&self, _context: &Context<'_>) -> Result<Text, Failure> {
        Ok(Text(TaskSource::Named(self.name.clone()).read()?.text))
    }
}
