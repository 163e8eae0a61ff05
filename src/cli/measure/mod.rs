//! `optimize measure`: what was measured on the bench, into and out of a file.

pub mod add;
pub mod check;

use super::{Failure, print};
use crate::session::SheetRequest;
use calibration::experiments::Experiment;
use clap::Subcommand;
use insertion::trial::NEVER;

/// Add measurements from the bench to a file, check such a file, or write a sheet to measure by.
///
/// The file is `docs/guide/measuring.md`'s measurements.csv. Only the task, the infill and something that
/// was measured are needed; a range alone is enough.
#[derive(Debug, Subcommand)]
pub enum Arguments {
    #[command(after_help = "Example: optimize measure add bench.csv --task ket8 --density 20 \
                            --direction 0 --range-mm 5.7 --failure-negative 3 --failure-positive 3")]
    Add(Box<add::Arguments>),
    #[command(after_help = "Example: optimize measure check bench.csv")]
    Check(check::Arguments),
    /// Write a sheet to print and fill in, to measure windows by hand
    #[command(
        after_help = "Example: optimize measure sheet --task usb --finger 10,0 --out sheet.html"
    )]
    Sheet(SheetRequest),
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match arguments {
        Arguments::Add(arguments) => add::run(arguments),
        Arguments::Check(arguments) => check::run(arguments),
        Arguments::Sheet(request) => {
            request.run(&NEVER)?;
            print(&format!("wrote {}\n", request.out.display()))
        }
    }
}

/// How many lines a file has, in words.
fn lines(found: &[Experiment]) -> String {
    match found.len() {
        1 => "1 line".to_owned(),
        count => format!("{count} lines"),
    }
}
