//! Interface of a command: a request, parsed from the command line or from keywords, and its output, printed as text
//! or as JSON.

use crate::context::Program;
use crate::{Context, Failure, terminal};
use clap::{Arg, ArgAction, ArgMatches, Args};
use serde::Serialize;
use serde_json::Value;
use std::ffi::OsString;
use std::path::PathBuf;
use study::write_file;

/// Input of a command: its fields are the options, its doc comments their help.
pub trait Request: Args {
    /// Whether the result can be printed as JSON.
    const JSON: bool = true;
    /// Whether the command shows its progress.
    const PROGRESS: bool = false;

    /// Runs the command.
    ///
    /// # Errors
    /// If an input cannot be used, a file cannot be written, or the run is cancelled.
    fn run(&self, context: &Context<'_>) -> Result<Output, Failure>;
}

/// Result of a command with its text for a terminal.
#[derive(Debug)]
pub struct Output {
    /// The result for `--json` and Python; an error if it contains a path that is not UTF-8.
    pub value: Result<Value, Failure>,
    /// Text for a terminal.
    pub text: String,
    /// SVG or HTML page that shows the result, if there is one.
    pub picture: Option<String>,
    /// Error with which the program ends after printing the result, for example if a task does not insert.
    pub failure: Option<Failure>,
}

impl Output {
    /// Returns a result with its text.
    pub fn new(text: String, value: impl Serialize) -> Self {
        // Not serialized directly: in a `Value`, the last of two flattened fields with the same key wins.
        let value = serde_json::to_value(value);
        let value = value.map_err(|error| Failure::running(error.to_string()));
        Output { value, text, picture: None, failure: None }
    }

    /// Adds a picture, which is also written to `file`, if that is given.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn drawn(self, picture: String, file: Option<&PathBuf>) -> Result<Self, Failure> {
        file.map_or(Ok(()), |file| write_file(file, &picture))?;
        Ok(Output { picture: Some(picture), ..self })
    }
}

/// A result that consists of text alone.
impl From<String> for Output {
    fn from(text: String) -> Self {
        Output::new(text.clone(), text)
    }
}

/// A command of the program.
#[derive(Clone, Copy)]
pub struct Command {
    /// Words that select the command: `["task", "new"]`.
    pub path: &'static [&'static str],
    /// Adds the options to a command of clap.
    pub augment: fn(clap::Command) -> clap::Command,
    /// Runs the command and prints its result; fails if the request does, or with [`Output::failure`].
    pub print: fn(&ArgMatches, Program) -> Result<(), Failure>,
    /// Runs the command for another program.
    pub call: fn(&ArgMatches, &Context<'_>) -> Result<Output, Failure>,
}

const JSON: &str = "json";
const QUIET: &str = "quiet";

impl Command {
    /// Returns the command of a request, selected by these words.
    pub const fn of<R: Request>(path: &'static [&'static str]) -> Self {
        Command { path, augment: augment::<R>, print: print::<R>, call: call::<R> }
    }

    /// Returns the clap definition of this command alone.
    pub fn clap(&self) -> clap::Command {
        (self.augment)(clap::Command::new(self.path.last().copied().unwrap_or_default()))
    }
}

fn augment<R: Request>(command: clap::Command) -> clap::Command {
    let flag = |name: &'static str, help: &'static str| {
        Arg::new(name).long(name).action(ArgAction::SetTrue).help(help)
    };
    let command = R::augment_args(command);
    let json = R::JSON.then(|| flag(JSON, "Print the result as JSON"));
    let quiet = R::PROGRESS.then(|| flag(QUIET, "Show no progress"));
    let command = command.args(json.into_iter().chain(quiet));
    // A negative number is then an error that names the accepted values.
    command.mut_args(|arg| match arg.get_long() {
        Some(_) if arg.get_action().takes_values() => arg.allow_negative_numbers(true),
        _ => arg,
    })
}

/// Parses a request from the words of a command line after the command's name.
///
/// # Errors
/// If they are not valid options of the request.
pub fn parse<R: Request>(
    words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
) -> Result<R, Failure> {
    let program = augment::<R>(clap::Command::new("optimize")).no_binary_name(true);
    request(&program.try_get_matches_from(words).map_err(Failure::of_clap)?)
}

fn request<R: Request>(matches: &ArgMatches) -> Result<R, Failure> {
    R::from_arg_matches(matches).map_err(Failure::of_clap)
}

fn print<R: Request>(matches: &ArgMatches, program: Program) -> Result<(), Failure> {
    let set = |name| matches.try_get_one::<bool>(name).ok().flatten().copied().unwrap_or(false);
    let json = set(JSON);
    let request = request::<R>(matches)?;
    let context = Context::terminal(json, set(QUIET), program);
    let Output { value, text, failure, .. } = request.run(&context)?;
    drop(context);
    terminal::print(&if json { value?.to_string() + "\n" } else { text })?;
    failure.map_or(Ok(()), Err)
}

fn call<R: Request>(matches: &ArgMatches, context: &Context<'_>) -> Result<Output, Failure> {
    request::<R>(matches)?.run(context)
}
