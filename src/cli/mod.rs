//! The command line: arguments in, checked configuration out, one file per command.

pub mod ask_tell;
pub mod bench;
mod bench_optimizers;
pub mod check;
pub mod compare;
pub mod cross_check;
pub mod evaluate;
pub mod export;
mod failure;
mod finger;
mod progress;
mod repeat;
pub mod report;
pub mod resume;
mod session;
mod setup;
pub mod stiffness;
pub mod study;
mod summary;
pub mod tasks;
pub mod trial;
pub mod validate;
mod words;

pub use failure::Failure;

use clap::{ArgMatches, Args, FromArgMatches, Parser, Subcommand};
use std::io::{self, Write};

/// Finds the 3D-printed compliant finger that makes a connector insertion most robust.
///
/// Without a subcommand it runs a study: it proposes fingers, simulates their
/// insertions from shifted starting positions, and searches for the finger that
/// tolerates the largest shift. Running the same command again continues the study.
///
/// Exit codes: 0 done, 1 failed or interrupted while running, 2 bad usage or bad input file.
#[derive(Debug, Parser)]
#[command(
    name = "optimize",
    version,
    subcommand_negates_reqs = true,
    args_conflicts_with_subcommands = true
)]
pub struct Cli {
    // First: reading the subcommand takes it out of the matches.
    #[command(flatten)]
    pub study: StudyOrNone,
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// The arguments of a study, if no subcommand took its place. (clap's own
/// `Option` does not see arguments that are flattened twice.)
#[derive(Debug)]
pub struct StudyOrNone(pub Option<study::Arguments>);

impl FromArgMatches for StudyOrNone {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = matches.subcommand_name().is_none();
        given.then(|| study::Arguments::from_arg_matches(matches)).transpose().map(StudyOrNone)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for StudyOrNone {
    fn augment_args(command: clap::Command) -> clap::Command {
        study::Arguments::augment_args(command)
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        study::Arguments::augment_args_for_update(command)
    }
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Continue a study after an interruption or a crash
    Resume(resume::Arguments),
    /// Write the tables and plots of a study again
    Report(report::Arguments),
    /// Measure the tolerance window of one finger
    Evaluate(evaluate::Arguments),
    /// Simulate one insertion
    Trial(trial::Arguments),
    /// Show the stiffness model and how well it fits
    Stiffness(stiffness::Arguments),
    /// Compare optimizers over studies of the same task and objective
    Compare(compare::Arguments),
    Check(check::Arguments),
    CrossCheck(cross_check::Arguments),
    Validate(validate::Arguments),
    Bench(bench::Arguments),
    Export(export::Arguments),
    /// Optimize anything: JSON lines on standard input and output
    AskTell(ask_tell::Arguments),
    /// List tasks, spaces, robots and uncertainties
    Tasks(tasks::Arguments),
}

/// Prints to standard output; a reader that has gone away (`| head`) is no error.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::running(format!("cannot write the output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a value as JSON, one line.
fn print_json(value: &serde_json::Value) -> Result<(), Failure> {
    print(&format!("{value}\n"))
}
