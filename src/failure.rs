//! Errors of requests, and the exit codes of the program.

use calibration::experiments::Problems;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use input::{InputError, Place, Placed, RequestError};
use insertion::DesignError;
use insertion::stiffness::SurrogateError;
use insertion::trial::run::RigError;
use report::ReportError;
use std::error::Error;
use std::fmt;
use std::ops::RangeInclusive;
use study::StudyError;

/// Error of a request. Texts name options of the command line; the keywords of Python have the same names.
#[derive(Debug)]
pub enum Failure {
    /// Bad usage or a bad input file: exit code 2.
    Input(anyhow::Error),
    /// A bad task file or an unknown task: exit code 2.
    Task(anyhow::Error),
    /// A runtime error, for example a file that cannot be written: exit code 1.
    Run(anyhow::Error),
    /// Cancelled, with a hint on how to continue, if that is possible: exit code 1.
    Interrupted(Option<String>),
}

fn place<E: Placed + Error + 'static>(error: &(dyn Error + 'static)) -> Option<Place> {
    error.downcast_ref::<E>().map(Placed::place)
}

/// Functions that return the place of an error (file, key and line), one for each type of error that has one.
const PLACED: [fn(&(dyn Error + 'static)) -> Option<Place>; 6] = [
    place::<InputError>,
    place::<RequestError>,
    place::<Problems>,
    place::<SurrogateError>,
    place::<DesignError>,
    place::<StudyError>,
];

impl Failure {
    /// Returns the exit code of the process.
    pub fn exit_code(&self) -> u8 {
        match self {
            Failure::Run(_) | Failure::Interrupted(_) => 1,
            Failure::Input(_) | Failure::Task(_) => 2,
        }
    }

    /// Returns the file, key and line of the problem in the input, as far as they are known.
    pub fn place(&self) -> Place {
        let error = match self {
            Failure::Input(error) | Failure::Task(error) | Failure::Run(error) => error,
            Failure::Interrupted(_) => return Place::default(),
        };
        let of = |error| PLACED.iter().find_map(|place| place(error));
        error.chain().find_map(of).unwrap_or_default()
    }

    /// Returns an error of bad input, for `map_err`.
    pub fn input(error: impl Into<anyhow::Error>) -> Self {
        Failure::Input(error.into())
    }

    /// Returns an error of bad usage with this text, which may begin with the option.
    pub fn usage(message: impl Into<String>) -> Self {
        let text = message.into();
        Failure::input(RequestError { place: Place::option(&text), text })
    }

    /// Returns an error of bad usage found by clap; its text begins with the option.
    pub fn of_clap(error: clap::Error) -> Self {
        if let (ErrorKind::MissingRequiredArgument, Some(ContextValue::Strings(missing))) =
            (error.kind(), error.get(ContextKind::InvalidArg))
        {
            let named: Vec<String> = missing.iter().map(|usage| options(usage)).collect();
            return Failure::usage(format!("give {}", named.join(" and ")));
        }
        let context = |kind| match error.get(kind) {
            Some(ContextValue::String(text)) => Some(text.as_str()),
            Some(ContextValue::Strings(texts)) => texts.first().map(String::as_str),
            _ => None,
        };
        let option = context(ContextKind::InvalidArg).and_then(|arg| arg.split(' ').next());
        let text = error.render().to_string();
        let text = text.strip_prefix("error: ").unwrap_or(&text).trim_end();
        // Drops the lines on how to get help.
        let text = text.split("\n\nUsage:").next().unwrap_or(text);
        let text = text.split("\n\nFor more information").next().unwrap_or(text);
        let text = plain_number_errors(text);
        let value = context(ContextKind::InvalidValue);
        Failure::usage(match (option, value, text.split_once("': ")) {
            (Some(option), Some(value), Some((_, why))) => {
                // The message of clap for a range is `0 is not in 1..=10000`.
                let range =
                    why.split_once(" is not in ").and_then(|(_, range)| range.split_once("..="));
                let range =
                    range.map(|(least, most)| format!("must lie between {least} and {most}"));
                format!("{option} {value}: {}", range.as_deref().unwrap_or(why))
            }
            (Some(option), ..) if option.starts_with("--") => format!("{option}: {text}"),
            _ => text,
        })
    }

    /// Returns an error of bad input in a file with this text.
    pub fn in_file(file: impl fmt::Display, problem: impl fmt::Display) -> Self {
        Failure::input(Place::file(file.to_string()).fault(problem.to_string()))
    }

    /// Returns an error of a bad task file, for `map_err`.
    pub fn task(error: impl Into<anyhow::Error>) -> Self {
        Failure::Task(error.into())
    }

    /// Returns a runtime error with this text.
    pub fn running(message: impl Into<String>) -> Self {
        Failure::Run(anyhow::Error::msg(message.into()))
    }
}

/// Replaces the standard library's errors of number parsing in a message of clap by the accepted values.
pub(crate) fn plain_number_errors(text: &str) -> String {
    const PROBLEMS: [(&str, &str); 6] = [
        ("invalid digit found in string", "must be a whole number, 0 or above"),
        ("cannot parse integer from empty string", "must be a whole number"),
        ("number too large to fit in target type", "the number is too large"),
        ("number too small to fit in target type", "the number is too small"),
        ("invalid float literal", "must be a number"),
        ("cannot parse float from empty string", "must be a number"),
    ];
    PROBLEMS.iter().fold(text.to_owned(), |text, (raw, plain)| text.replace(raw, plain))
}

/// Checks that the number given by `option`, if there is one, lies in its range.
pub fn within<T: PartialOrd + fmt::Display>(
    option: &str,
    number: impl Into<Option<T>>,
    range: &RangeInclusive<T>,
) -> Result<(), Failure> {
    match number.into() {
        Some(number) if !range.contains(&number) => {
            let (least, most) = (range.start(), range.end());
            Err(Failure::usage(format!("{option} {number}: must lie between {least} and {most}")))
        }
        _ => Ok(()),
    }
}

/// Returns an error of bad configuration in the folder of a study.
pub fn bad_config(error: impl fmt::Display) -> Failure {
    Failure::in_file("study.toml", error)
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        let bad_input = error.is_bad_input();
        let error = anyhow::Error::new(error);
        if bad_input { Failure::Input(error) } else { Failure::Run(error) }
    }
}

/// Implements the conversions of errors of bad input.
macro_rules! bad_input {
    ($($error:ty),*) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Failure::input(error)
            }
        }
    )*};
}

bad_input!(InputError, DesignError, RigError);

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        Failure::Run(error.into())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // Not `{error:#}`: the texts already include their causes.
            Failure::Input(error) | Failure::Task(error) | Failure::Run(error) => {
                f.write_str(&truncated(&error.to_string()))
            }
            Failure::Interrupted(None) => f.write_str("interrupted"),
            Failure::Interrupted(Some(hint)) => write!(f, "interrupted; {hint}"),
        }
    }
}

/// Returns the options in a usage text of clap: `--plug` or `--round` of `<--plug <WxHxL>|--round <DxL>>`.
fn options(usage: &str) -> String {
    let names = usage.split(['<', '>', '|', ' ', '[', ']']);
    let names: Vec<&str> = names.filter(|name| name.starts_with("--")).collect();
    if names.is_empty() {
        usage.trim_matches(['<', '>', '[', ']', '.']).to_owned()
    } else {
        names.join(" or ")
    }
}

/// Largest length of a line of a message, characters; a message may quote a file.
const MAX_LINE_LENGTH: usize = 600;
/// Largest number of lines of a message.
const MAX_LINES: usize = 60;

/// Shortens a message to the largest length and number of lines.
fn truncated(text: &str) -> String {
    let line = |line: &str| match line.char_indices().nth(MAX_LINE_LENGTH) {
        Some((end, _)) => format!("{} .. (cut)", &line[..end]),
        None => line.to_owned(),
    };
    let left_out = text.lines().count().saturating_sub(MAX_LINES);
    let more = (left_out > 0).then(|| format!(".. and {left_out} lines more"));
    text.lines().take(MAX_LINES).map(line).chain(more).collect::<Vec<_>>().join("\n")
}
