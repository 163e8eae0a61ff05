//! Runs the program `lab`.
#![allow(dead_code, reason = "each test file uses its own part of this")]

#[path = "../../../tests/common/ran.rs"]
mod ran;

pub use ran::*;

use std::process::{Command, Stdio};

/// Returns the command that runs the program with these arguments in the root of the workspace.
pub fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lab"));
    command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    command.args(arguments).stdin(Stdio::null());
    command
}

pub fn lab(arguments: &[&str]) -> Ran {
    run(&mut command(arguments))
}
