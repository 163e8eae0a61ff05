//! `optimize`: finds the most robust compliant finger for a connector task.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    finger_opt::program::main(std::env::args_os())
}
