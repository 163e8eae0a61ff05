//! `optimize`: finds the most robust compliant finger for a connector task.

use std::process::ExitCode;

fn main() -> ExitCode {
    finger_opt::program::main(std::env::args_os())
}
