//! Errors of a study's folder, said so that they can be mended.

use input::{Place, Placed};
use insertion::evaluation::template::Impossible;
use std::io;
use std::path::{Path, PathBuf};

/// Error of a study.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The file system refused something.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// Action tried, after "cannot".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's answer.
        source: io::Error,
    },
    /// Another process writes to this study.
    #[error(
        "{}: another process ({owner}) is running this study; wait for it, or give another --out",
        dir.display()
    )]
    Locked {
        /// The study's folder.
        dir: PathBuf,
        /// Who, as far as it is known.
        owner: String,
    },
    /// A file of the folder, or the whole of it, cannot be used as it is.
    #[error("{}: {problem}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// Problem, and what would be right.
        problem: String,
    },
    /// Somebody else has had a hand in the journal while the study ran.
    #[error(
        "{}: {problem} while the study ran, so it was stopped; {}",
        path.display(),
        rescue(kept)
    )]
    Interfered {
        /// The journal.
        path: PathBuf,
        /// Interference found.
        problem: String,
        /// Where everything measured was written to, or why it could not be.
        kept: Result<PathBuf, String>,
    },
    /// A design of the space cannot be simulated.
    #[error("evaluation {index} of {design} is impossible: {source}; narrow the space")]
    Impossible {
        /// The evaluation, counted from 0.
        index: u64,
        /// The design.
        design: String,
        /// Its wrong setting.
        source: Impossible,
    },
}

impl Placed for StudyError {
    fn place(&self) -> Place {
        match self {
            StudyError::Io { path, .. }
            | StudyError::Locked { dir: path, .. }
            | StudyError::File { path, .. }
            | StudyError::Interfered { path, .. } => Place::file(path.display().to_string()),
            StudyError::Impossible { source, .. } => source.place(),
        }
    }
}

impl StudyError {
    /// Whether the input is at fault (exit code 2) rather than the run (exit code 1).
    pub fn is_bad_input(&self) -> bool {
        use StudyError::{Interfered, Io, Locked};
        !matches!(self, Io { .. } | Locked { .. } | Interfered { .. })
    }

    /// For `map_err`: the file system's answer to `action` on `path`.
    pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> StudyError {
        let path = path.to_owned();
        move |source| StudyError::Io { action, path, source }
    }

    /// Error for a problem of a file or folder.
    pub(super) fn file(path: &Path, problem: impl ToString) -> StudyError {
        StudyError::File { path: path.to_owned(), problem: problem.to_string() }
    }
}

fn rescue(kept: &Result<PathBuf, String>) -> String {
    match kept {
        Ok(path) => format!(
            "all that was measured is in {}: to go on, put that in its place and resume",
            path.display()
        ),
        Err(problem) => format!("what was measured could not be saved: {problem}"),
    }
}

/// Fault of one line; the journal adds the file and the line number.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum LineError {
    /// No check, or one that does not fit.
    #[error("damaged: its contents do not fit its `check`")]
    Check,
    /// The check fits, the contents do not.
    #[error("not a line of this program's journals: {0}")]
    Format(String),
    /// Lines are missing, doubled or in the wrong order.
    #[error("evaluation {0} stands where evaluation {1} belongs")]
    Order(u64, u64),
}
