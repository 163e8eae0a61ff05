//! `lab`: verification of the models.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    lab::cli::main(std::env::args_os())
}
