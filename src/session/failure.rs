//! Why a request failed, and the exit code that says so.

use crate::report::ReportError;
use crate::study::StudyError;
use std::fmt;
use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicBool, Ordering};

/// Why a request failed. The texts name options as the command line has them; Python's keywords are
/// the same words.
#[derive(Debug)]
pub enum Failure {
    /// Bad usage or a bad input file: exit code 2.
    Input(anyhow::Error),
    /// Something failed, or was interrupted, while running: exit code 1.
    Run(anyhow::Error),
}

impl Failure {
    /// The process's exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Failure::Run(_) => 1,
            Failure::Input(_) => 2,
        }
    }

    /// Bad input, for `map_err`.
    pub fn input(error: impl Into<anyhow::Error>) -> Self {
        Failure::Input(error.into())
    }

    /// Bad input, described.
    pub fn usage(message: impl Into<String>) -> Self {
        Failure::Input(anyhow::Error::msg(message.into()))
    }

    /// Failed while running, described.
    pub fn running(message: impl Into<String>) -> Self {
        Failure::Run(anyhow::Error::msg(message.into()))
    }
}

/// Whether nobody has asked to stop.
///
/// # Errors
/// That it was interrupted, if `stop` is set: what was computed meanwhile is worthless.
pub(super) fn not_stopped(stop: &AtomicBool) -> Result<(), Failure> {
    match stop.load(Ordering::SeqCst) {
        true => Err(Failure::running("interrupted")),
        false => Ok(()),
    }
}

/// Whether a number lies in its range, if it is given; `option` is what gives it.
pub(super) fn within<T: PartialOrd + fmt::Display>(
    option: &str,
    number: impl Into<Option<T>>,
    range: &RangeInclusive<T>,
) -> Result<(), Failure> {
    match number.into() {
        Some(number) if !range.contains(&number) => {
            let (least, most) = (range.start(), range.end());
            let problem = format!("{option} {number}: must lie between {least} and {most}");
            Err(Failure::usage(problem))
        }
        _ => Ok(()),
    }
}

/// A range as clap takes it of numbers narrower than its own.
pub(crate) fn wide<T: Copy + Into<i64>>(range: &RangeInclusive<T>) -> RangeInclusive<i64> {
    (*range.start()).into()..=(*range.end()).into()
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        let bad_input = error.is_bad_input();
        let error = anyhow::Error::new(error);
        if bad_input { Failure::Input(error) } else { Failure::Run(error) }
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        Failure::Run(error.into())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // The errors' own texts already hold their causes, so not `{error:#}`.
            Failure::Input(error) | Failure::Run(error) => f.write_str(&short(&error.to_string())),
        }
    }
}

/// Longest line of a message, and most lines, in characters: what it quotes of a file may be anything.
const LONGEST: usize = 600;
const MOST_LINES: usize = 60;

fn short(text: &str) -> String {
    let line = |line: &str| match line.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} .. (cut)", &line[..end]),
        None => line.to_owned(),
    };
    let left_out = text.lines().count().saturating_sub(MOST_LINES);
    let more = (left_out > 0).then(|| format!(".. and {left_out} lines more"));
    text.lines().take(MOST_LINES).map(line).chain(more).collect::<Vec<_>>().join("\n")
}
