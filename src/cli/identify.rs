//! `optimize identify`: from the robot's logs to the numbers of its cell.

use super::words::wrapped;
use super::{Failure, print, print_json};
use crate::session::IdentifyRequest;
use clap::Args;
use insertion::trial::NEVER;
use report::identify as shown;

/// Tell from the robot's logs what its cell is like: friction, stiffness, preload, pads, edges
///
/// The attempts are simulated along their commanded paths. What force and pose tell by themselves is read
/// by formulas, the rest is fitted to the curves; what these logs cannot tell is named and left as it was.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: IdentifyRequest,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let done = arguments.request.run(&NEVER)?;
    if arguments.json {
        return print_json(&shown::json(&done));
    }
    let written = arguments.request.written();
    let wrote: String = written.map(|file| format!("wrote         {}\n", file.display())).collect();
    print(&format!("{}{wrote}", wrapped(&shown::text(&done))))
}
