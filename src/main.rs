//! `optimize`: finds the most robust compliant finger for a connector task.
#![forbid(unsafe_code)]

mod cli;

use clap::Parser;
use cli::{Cli, Command, Failure};
use std::process::ExitCode;

fn main() -> ExitCode {
    match dispatch(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}

/// A study searches a space for the design with the best objective; the other
/// commands look at one step of that way each.
fn dispatch(cli: Cli) -> Result<(), Failure> {
    match cli.command {
        None => match cli.study.0 {
            Some(arguments) => cli::study::run(&arguments),
            None => Err(Failure::no_task()),
        },
        Some(Command::Resume(arguments)) => cli::resume::run(&arguments),
        Some(Command::Report(arguments)) => cli::report::run(&arguments),
        Some(Command::Evaluate(arguments)) => cli::evaluate::run(&arguments),
        Some(Command::Trial(arguments)) => cli::trial::run(&arguments),
        Some(Command::Stiffness(arguments)) => cli::stiffness::run(&arguments),
        Some(Command::Compare(arguments)) => cli::compare::run(&arguments),
        Some(Command::Check(arguments)) => cli::check::run(&arguments),
        Some(Command::CrossCheck(arguments)) => cli::cross_check::run(&arguments),
        Some(Command::Validate(arguments)) => cli::validate::run(&arguments),
        Some(Command::Bench(arguments)) => cli::bench::run(&arguments),
        Some(Command::Export(arguments)) => cli::export::run(&arguments),
        Some(Command::AskTell(arguments)) => cli::ask_tell::run(&arguments),
        Some(Command::Tasks(arguments)) => cli::tasks::run(&arguments),
    }
}
