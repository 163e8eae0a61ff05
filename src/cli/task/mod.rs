//! `optimize task`: one's own connector.

pub mod check;
pub mod import;
pub mod new;
pub mod tune;

use super::{Failure, print};
use crate::session::TaskSource;
use clap::Subcommand;

/// Make, show and check a task
#[derive(Debug, Subcommand)]
pub enum Arguments {
    /// Write a commented task file from a few dimensions, or like another task
    #[command(
        after_help = "Example: optimize task new usb-c --plug 8.25x2.4x6.65 --clearance 0.1 \
                            --body 12x6.5x20"
    )]
    New(new::Arguments),
    /// Print a shipped task file
    #[command(after_help = "Example: optimize task show usb > mine.toml")]
    Show {
        /// Task: ket8, ket12, rj45, usb
        #[arg(value_name = "NAME")]
        name: String,
    },
    /// Look for what cannot work in a task file, draw it and try its nominal start
    ///
    /// Exit code 0 if nothing is wrong and the plug goes in, 2 otherwise.
    #[command(after_help = "Example: optimize task check usb-c.toml --svg usb-c.svg")]
    Check(check::Arguments),
    #[command(after_help = "Example: optimize task import --plug plug.stl --socket socket.stl \
                            --out mine.toml")]
    Import(import::Arguments),
    #[command(after_help = "Example: optimize task tune mine.toml --svg mine.svg")]
    Tune(tune::Arguments),
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match arguments {
        Arguments::New(arguments) => new::run(arguments),
        Arguments::Show { name } => print(&TaskSource::Named(name.clone()).read()?.text),
        Arguments::Check(arguments) => check::run(arguments),
        Arguments::Import(arguments) => import::run(arguments),
        Arguments::Tune(arguments) => tune::run(arguments),
    }
}
