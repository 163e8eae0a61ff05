//! The command line: arguments in, checked configuration out, one file per command.

mod ask_tell;
mod calibrate;
pub mod call;
mod chosen;
mod compare;
pub mod evaluate;
mod executor;
mod export;
mod finger;
mod identify;
mod levers;
mod manual;
pub mod map;
mod measure;
mod next;
mod progress;
mod recommended;
mod repeat;
mod report;
mod robots;
mod sensitivity;
mod stiffness;
mod study;
mod summary;
mod task;
mod tasks;
pub mod terminal;
pub mod trial;
mod words;

use crate::session::Failure;
pub use manual::{commands, reference};
pub use task::import::json as imported_json;
use terminal::{print, print_json, say};

use clap::{ArgMatches, Args, FromArgMatches, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::LazyLock;

/// Version, commit and the first digits of the sources' hash.
static LONG_VERSION: LazyLock<String> = LazyLock::new(|| {
    let [version, commit] = [env!("CARGO_PKG_VERSION"), env!("FINGER_OPT_COMMIT")];
    format!("{version} ({commit}, sources {})", &::study::SOURCES[..8])
});

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
    long_version = LONG_VERSION.as_str(),
    subcommand_negates_reqs = true,
    arg_required_else_help = true,
    args_conflicts_with_subcommands = true,
    after_help = "Example: optimize --task usb --budget 200"
)]
struct Cli {
    // First: reading the subcommand takes it out of the matches.
    #[command(flatten)]
    study: StudyOrNone,
    #[command(subcommand)]
    command: Option<Command>,
}

impl Cli {
    /// Where a study is to be measured, if not here.
    fn executor(&self) -> Option<&str> {
        let run = match &self.command {
            None => &self.study.0.as_ref()?.request.run,
            Some(Command::Resume(arguments)) => &arguments.request.run,
            Some(_) => return None,
        };
        run.executor.as_deref()
    }
}

/// The arguments of a study, if no subcommand took its place. (clap's own
/// `Option` does not see arguments that are flattened twice.)
#[derive(Debug)]
struct StudyOrNone(Option<study::Arguments>);

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
enum Command {
    /// Continue a study after an interruption or a crash
    #[command(after_help = "Example: optimize resume results/usb-gp-seed0")]
    Resume(study::ResumeArguments),
    /// Write the tables and plots of a study again
    #[command(after_help = "Example: optimize report results/usb-gp-seed0")]
    Report(report::Arguments),
    /// Measure the tolerance window of one finger
    #[command(
        after_help = "Example: optimize evaluate --task usb --density 20 --direction 10 --walk"
    )]
    Evaluate(evaluate::Arguments),
    /// Simulate one insertion
    #[command(after_help = "Example: optimize trial --task ket12 --density 10 --direction 0 \
                            --offset-mm 0.5 --svg trial.svg")]
    Trial(trial::Arguments),
    #[command(
        after_help = "Example: optimize map --task usb --density 10 --direction 26 --axes y,yaw \
                            --svg map.svg"
    )]
    Map(map::Arguments),
    /// Show the stiffness model and how well it fits
    #[command(after_help = "Example: optimize stiffness --stiffness-data mine.csv --svg model.svg")]
    Stiffness(stiffness::Arguments),
    #[command(after_help = "Example: optimize finger --density 20 --direction 20 --svg finger.svg")]
    Finger(finger::Arguments),
    /// Compare optimizers over studies of the same task and objective
    #[command(
        after_help = "Example: optimize compare results/usb-gp-seed0 results/usb-sobol-seed0"
    )]
    Compare(compare::Arguments),
    #[command(
        after_help = "Example: optimize sensitivity --task usb --space codesign --svg usb.svg"
    )]
    Sensitivity(sensitivity::Arguments),
    #[command(
        after_help = "Example: optimize levers --task rj45 --density 18 --direction 20 --svg rj45.svg"
    )]
    Levers(levers::Arguments),
    #[command(
        after_help = "Example: optimize calibrate --task ket8 --measurements published --out results/ket8-bench"
    )]
    Calibrate(calibrate::Arguments),
    #[command(
        after_help = "Example: optimize identify --task usb --runs runs.csv --out cell.toml \
                            --report identify.html"
    )]
    Identify(identify::Arguments),
    #[command(after_help = "Example: optimize next --task ket8 --measurements bench.csv --count 2")]
    Next(next::Arguments),
    #[command(subcommand, after_help = "Example: optimize measure check published")]
    Measure(measure::Arguments),
    #[command(
        subcommand,
        after_help = "Example: optimize export mjcf --task usb --density 20 --direction 10 \
                            --out scene.xml"
    )]
    Export(export::Arguments),
    /// Optimize anything: JSON lines on standard input and output
    #[command(
        after_help = "Example: optimize ask-tell < session.jsonl; docs/guide/python.md has the lines"
    )]
    AskTell,
    #[command(after_help = "Example: optimize robots --json")]
    Robots(robots::Arguments),
    /// List tasks, spaces and uncertainties
    #[command(after_help = "Example: optimize tasks --json")]
    Tasks(tasks::Arguments),
    #[command(
        subcommand,
        after_help = "Example: optimize task new usb-c --plug 8.25x2.4x6.65 --clearance 0.1 \
                            --body 12x6.5x20"
    )]
    Task(task::Arguments),
    /// Print a completion script for a shell
    #[command(after_help = "Example: optimize completions bash > optimize.bash")]
    Completions(manual::CompletionArguments),
    /// Print the manual page
    #[command(after_help = "Example: optimize man > optimize.1")]
    Man,
}

/// Runs `optimize` with these arguments, the program's name first.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    survive_size_limit();
    let words: Vec<OsString> = arguments.into_iter().collect();
    if let Some(now) = moved(&words) {
        say(&format!("error: this command is now `{now}` (cargo run --release -p lab -- ...)"));
        return ExitCode::from(2);
    }
    let cli = match Cli::try_parse_from(&words) {
        Ok(cli) => cli,
        Err(usage) if usage.use_stderr() => {
            say(usage.render().to_string().trim_end());
            return ExitCode::from(2);
        }
        // Help and version come this way, too.
        Err(asked) => asked.exit(),
    };
    let done = match cli.executor() {
        Some(executor) => executor::run(executor, words.get(1..).unwrap_or_default()),
        None => dispatch(cli).map(|()| ExitCode::SUCCESS),
    };
    done.unwrap_or_else(|failure| {
        say(&format!("error: {failure}"));
        ExitCode::from(failure.exit_code())
    })
}

/// Name in the program `lab` of a command of version 0.3.0; `None` of all others.
fn moved(words: &[OsString]) -> Option<&'static str> {
    let word = |at: usize| words.get(at).and_then(|word| word.to_str()).unwrap_or_default();
    Some(match (word(1), word(2)) {
        ("check", _) => "lab check",
        ("validate", _) => "lab validate",
        ("cross-check", _) => "lab cross-check",
        ("bench", "optimizers") => "lab optimizers",
        ("bench", "next") => return None,
        ("bench", _) => "lab benchmark",
        _ => return None,
    })
}

/// Lets a write beyond `ulimit -f` fail like one to a full disk; unasked the system ends the
/// process without a word.
fn survive_size_limit() {
    // What cannot be registered leaves all as it was.
    #[cfg(unix)]
    let _ = signal_hook::flag::register(libc::SIGXFSZ, Default::default());
}

/// A study searches a space for the design with the best objective; the other
/// commands look at one step of that way each.
fn dispatch(cli: Cli) -> Result<(), Failure> {
    match cli.command {
        None => match cli.study.0 {
            Some(arguments) => study::to_its_end(arguments.request.open(None)?, arguments.shown),
            None => Err(Failure::usage("give --task NAME, or a subcommand; see `optimize --help`")),
        },
        Some(Command::Resume(arguments)) => {
            study::to_its_end(arguments.request.open()?, arguments.shown)
        }
        Some(Command::Report(arguments)) => report::run(&arguments),
        Some(Command::Evaluate(arguments)) => evaluate::run(&arguments),
        Some(Command::Trial(arguments)) => trial::run(&arguments),
        Some(Command::Map(arguments)) => map::run(&arguments),
        Some(Command::Stiffness(arguments)) => stiffness::run(&arguments),
        Some(Command::Finger(arguments)) => finger::run(&arguments),
        Some(Command::Compare(arguments)) => compare::run(&arguments),
        Some(Command::Sensitivity(arguments)) => sensitivity::run(&arguments),
        Some(Command::Levers(arguments)) => levers::run(&arguments),
        Some(Command::Calibrate(arguments)) => calibrate::run(&arguments),
        Some(Command::Identify(arguments)) => identify::run(&arguments),
        Some(Command::Next(arguments)) => next::run(&arguments),
        Some(Command::Measure(arguments)) => measure::run(&arguments),
        Some(Command::Export(arguments)) => export::run(&arguments),
        Some(Command::AskTell) => ask_tell::run(),
        Some(Command::Robots(arguments)) => robots::run(&arguments),
        Some(Command::Tasks(arguments)) => tasks::run(&arguments),
        Some(Command::Task(arguments)) => task::run(&arguments),
        Some(Command::Completions(arguments)) => manual::completions(&arguments),
        Some(Command::Man) => manual::page(),
    }
}
