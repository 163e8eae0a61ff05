//! Command line of `lab`, a file for each command.

mod check;
mod cross_check;
mod identify;
mod landscape;
mod map;
mod optimizers;
mod settle;
mod validate;
mod windows;

use clap::{Parser, Subcommand};
use finger_opt::failure::Failure;
use finger_opt::terminal::{print, say};
use std::ffi::OsString;
use std::process::ExitCode;

/// Prints a value as JSON, one line.
fn print_json(value: &serde_json::Value) -> Result<(), Failure> {
    print(&format!("{value}\n"))
}

/// Checks the models behind `optimize`: against closed formulas, other engines and published tables.
///
/// Exit codes: 0 done, 1 failed while running or a check failed, 2 bad usage or bad input file.
#[derive(Debug, Parser)]
#[command(
    name = "lab",
    version,
    arg_required_else_help = true,
    after_help = "Example: cargo run --release -p lab -- check"
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
    #[command(after_help = "Example: lab validate --task ket8 --strides")]
    Validate(validate::Arguments),
    #[command(after_help = "Example: lab windows --random 40 --out windows.csv")]
    Windows(windows::Arguments),
    #[command(after_help = "Example: lab optimizers --functions branin --optimizers gp")]
    Optimizers(optimizers::Arguments),
    #[command(after_help = "Example: lab settle --landscape results/reference/landscapes/usb.csv")]
    Settle(settle::Arguments),
    #[command(after_help = "Example: lab landscape --task usb --out usb.csv")]
    Landscape(landscape::Arguments),
    #[command(after_help = "Example: lab identify truth --cells 1..20 --out truth.csv")]
    Identify(identify::Arguments),
    #[command(after_help = "Example: lab map --task usb --density 10 --direction 26 --out usb.csv")]
    Map(map::Arguments),
}

/// Runs `lab` with these arguments, the program's name first.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(usage) if usage.use_stderr() => {
            say(usage.render().to_string().trim_end());
            return ExitCode::from(2);
        }
        // Help and version come this way, too.
        Err(asked) => asked.exit(),
    };
    let done = match &cli.command {
        Command::Check(arguments) => check::run(arguments),
        Command::CrossCheck(arguments) => cross_check::run(arguments),
        Command::Validate(arguments) => validate::run(arguments),
        Command::Windows(arguments) => windows::run(arguments),
        Command::Optimizers(arguments) => optimizers::run(arguments),
        Command::Landscape(arguments) => landscape::run(arguments),
        Command::Identify(arguments) => identify::run(arguments),
        Command::Map(arguments) => map::run(arguments),
        Command::Settle(arguments) => settle::run(arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            say(&format!("error: {failure}"));
            ExitCode::from(failure.exit_code())
        }
    }
}
