//! `optimize`: finds the most robust compliant finger for a connector task.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    finger_opt::cli::main(std::env::args_os())
}
