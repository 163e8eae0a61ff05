//! Interface of a command: a request, parsed from the command line or from keywords, and a response, printed as text
//! or as JSON.

use crate::context::{Context, Program};
use crate::failure::Failure;
use crate::terminal;
use clap::{Arg, ArgAction, ArgMatches, Args};
use serde::Serialize;
use std::ffi::OsString;
use std::fmt;
use std::path::PathBuf;
use study::write_file;

/// Input of a command: its fields are the options, its doc comments their help.
pub trait Request: Args {
    /// Result of the command.
    type Response: Response;
    /// Whether the result can be printed as JSON.
    const JSON: bool = true;
    /// Whether the command shows its progress.
    const PROGRESS: bool = false;

    /// Runs the command.
    ///
    /// # Errors
    /// If an input cannot be used, a file cannot be written, or the run is cancelled.
    fn run(&self, context: &Context<'_>) -> Result<Self::Response, Failure>;
}

/// Result of a command, serialized for `--json` and Python, displayed for a terminal.
pub trait Response: Serialize + fmt::Display + Sized {
    /// Returns an SVG or a page that shows the result, if there is one.
    ///
    /// # Errors
    /// If it cannot be drawn.
    fn picture(&self) -> Result<Option<String>, Failure> {
        Ok(None)
    }

    /// Returns the error with which the program ends after printing the result.
    ///
    /// # Errors
    /// If the result is a failure, for example a task that does not insert.
    fn verdict(self) -> Result<(), Failure> {
        Ok(())
    }
}

/// Value for `--json` and its text for a terminal.
#[derive(Debug, Default, Serialize)]
#[serde(transparent)]
pub struct Output<T> {
    /// The value.
    pub value: T,
    /// Its text.
    #[serde(skip)]
    pub text: String,
    /// SVG or page that shows it, if there is one.
    #[serde(skip)]
    pub picture: Option<String>,
}

impl<T> Output<T> {
    /// Returns a value with its picture, which is also written to `file`, if that is given.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn drawn(
        (value, text): (T, String),
        picture: String,
        file: Option<&PathBuf>,
    ) -> Result<Self, Failure> {
        file.map_or(Ok(()), |file| write_file(file, &picture))?;
        Ok(Output { value, text, picture: Some(picture) })
    }
}

impl<T> fmt::Display for Output<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl<T: Serialize> Response for Output<T> {
    fn picture(&self) -> Result<Option<String>, Failure> {
        Ok(self.picture.clone())
    }
}

/// Result that consists of text alone.
pub type Text = Output<String>;

impl From<String> for Text {
    fn from(text: String) -> Self {
        Output { value: text.clone(), text, picture: None }
    }
}

/// Result of a command for other programs.
#[derive(Debug)]
pub struct CallResult {
    /// Output of `--json`.
    pub json: String,
    /// SVG or page that shows the result, if there is one.
    pub picture: Option<String>,
}

/// A command of the program.
#[derive(Clone, Copy)]
pub struct Command {
    /// Words that select it: `["task", "new"]`.
    pub path: &'static [&'static str],
    /// Adds its options to a command of clap.
    pub augment: fn(clap::Command) -> clap::Command,
    /// Runs it and prints its result; fails if the request does, or by [`Response::verdict`].
    pub print: fn(&ArgMatches, Program) -> Result<(), Failure>,
    /// Runs it for another program.
    pub call: fn(&ArgMatches, &Context<'_>) -> Result<CallResult, Failure>,
}

const JSON: &str = "json";
const QUIET: &str = "quiet";

impl Command {
    /// Returns the command of a request, selected by these words.
    pub const fn of<R: Request>(path: &'static [&'static str]) -> Self {
        Command { path, augment: augment::<R>, print: print::<R>, call: call::<R> }
    }

    /// Returns the command line of this command alone.
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
    command.args(json.into_iter().chain(quiet))
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
    let response = request.run(&context)?;
    drop(context);
    match json {
        true => terminal::print(&(to_json(&response)? + "\n"))?,
        false => terminal::print(&response.to_string())?,
    }
    response.verdict()
}

fn call<R: Request>(matches: &ArgMatches, context: &Context<'_>) -> Result<CallResult, Failure> {
    let response = request::<R>(matches)?.run(context)?;
    Ok(CallResult { json: to_json(&response)?, picture: response.picture()? })
}

fn to_json(response: &impl Serialize) -> Result<String, Failure> {
    // Serialized to a value first, so that the last of two flattened parts with the same key wins.
    let value = serde_json::to_value(response);
    Ok(value.map_err(|error| Failure::running(error.to_string()))?.to_string())
}
