//! Why a command failed, and the exit code that says so.

use crate::study::StudyError;
use std::fmt;

/// Why a command failed.
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

    /// Neither a subcommand nor a study was asked for.
    pub fn no_task() -> Self {
        Failure::usage("give --task NAME and --budget N, or a subcommand; see `optimize --help`")
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        let bad_input = error.is_bad_input();
        let error = anyhow::Error::new(error);
        if bad_input { Failure::Input(error) } else { Failure::Run(error) }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // The errors' own texts already hold their causes, so not `{error:#}`.
            Failure::Input(error) | Failure::Run(error) => write!(f, "{error}"),
        }
    }
}
