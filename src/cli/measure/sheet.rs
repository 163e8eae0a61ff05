//! `optimize measure sheet`.

use crate::cli::{Failure, print};
use crate::session::SheetRequest;
use clap::Args;
use insertion::trial::NEVER;

/// Write a sheet to print and fill in, for measuring without a program that moves the robot
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: SheetRequest,
}

pub fn run(Arguments { request }: &Arguments) -> Result<(), Failure> {
    request.run(&NEVER)?;
    print(&format!("wrote {}: {} pages of A4\n", request.out.display(), request.finger.len() + 1))
}
