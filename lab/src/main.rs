//! `lab`: verification of the models by analytic checks and other engines.
#![forbid(unsafe_code)]
// These macros panic if the stream is closed; `finger_opt::terminal` prints instead.
#![deny(clippy::print_stdout, clippy::print_stderr)]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod check;
mod compare;
mod cross_check;

use clap::{Parser, Subcommand};
use finger_opt::Failure;
use finger_opt::terminal::{print, say};
use std::process::ExitCode;

/// Checks the models behind `optimize`: against closed formulas and other engines.
///
/// Exit codes: 0 done, 1 failed while running or a check failed, 2 bad usage or bad input file.
#[derive(Debug, Parser)]
#[command(
    name = "lab",
    version,
    arg_required_else_help = true,
    after_help = "Example: cargo run --release -p lab --bin lab -- check"
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    #[command(after_help = "Example: lab check")]
    Check(check::Arguments),
    #[command(after_help = "Example: lab cross-check --against mujoco --reduced")]
    CrossCheck(cross_check::Arguments),
}

fn main() -> ExitCode {
    let done = match &Cli::parse().command {
        Command::Check(arguments) => check::run(arguments),
        Command::CrossCheck(arguments) => cross_check::run(arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            say(&format!("error: {failure}"));
            ExitCode::from(failure.exit_code())
        }
    }
}
