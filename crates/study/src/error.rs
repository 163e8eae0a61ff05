//! Errors of a study.

use input::{Place, Placed};
use insertion::{Design, DesignError};
use std::io;
use std::path::{Path, PathBuf};

/// Error of a study.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The file system reported an error.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// Action that failed, after "cannot".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// Another process has opened this study.
    #[error(
        "{}: another process ({owner}) is running this study; wait for it, or give another --out",
        dir.display()
    )]
    Locked {
        /// The study's folder.
        dir: PathBuf,
        /// The word "number" and the process ID, or a text if the ID is unknown.
        owner: String,
    },
    /// The folder or one of its files is invalid.
    #[error("{}: {problem}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// Problem and remedy.
        problem: String,
    },
    /// Another program changed the journal during the run.
    #[error(
        "{}: {problem} while the study ran, so it was stopped; restore the file and resume: evaluations \
         in the cache are not simulated again",
        path.display()
    )]
    JournalChanged {
        /// The journal.
        path: PathBuf,
        /// The change.
        problem: String,
    },
    /// A design of the space cannot be simulated.
    #[error("evaluation {index} of {design} is impossible: {source}; narrow the space")]
    Impossible {
        /// The evaluation, counted from 0.
        index: u64,
        /// The design.
        design: String,
        /// Reason.
        source: Box<DesignError>,
    },
}

impl Placed for StudyError {
    fn place(&self) -> Place {
        match self {
            StudyError::Io { path, .. }
            | StudyError::Locked { dir: path, .. }
            | StudyError::File { path, .. }
            | StudyError::JournalChanged { path, .. } => Place::file(path.display().to_string()),
            StudyError::Impossible { source, .. } => source.place(),
        }
    }
}

impl StudyError {
    /// Returns whether the input is wrong (exit code 2) rather than the run (exit code 1).
    pub fn is_bad_input(&self) -> bool {
        matches!(self, StudyError::File { .. } | StudyError::Impossible { .. })
    }

    /// Returns the error for a design that cannot be simulated.
    pub fn impossible(index: u64, design: &Design, source: DesignError) -> StudyError {
        StudyError::Impossible { index, design: design.to_string(), source: Box::new(source) }
    }

    /// Returns a function for `map_err` that adds `action` and `path` to an error of the file system.
    pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> StudyError {
        let path = path.to_owned();
        move |source| StudyError::Io { action, path, source }
    }

    /// Returns the error for a problem of a file or folder.
    pub(super) fn file(path: &Path, problem: impl ToString) -> StudyError {
        StudyError::File { path: path.to_owned(), problem: problem.to_string() }
    }
}

/// Error of one line; the journal adds the file and the line number.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum LineError {
    /// The checksum is missing or wrong.
    #[error("damaged: the contents do not match the checksum `check`")]
    Check,
    /// The checksum is right, the contents are not valid.
    #[error("not a line of this program's journals: {0}")]
    Format(String),
    /// Lines are missing, repeated or in the wrong order.
    #[error("evaluation {0} is found where evaluation {1} is expected")]
    Order(u64, u64),
}
