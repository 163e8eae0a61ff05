//! What can go wrong with a study's folder, said so that it can be mended.

use insertion::evaluation::template::Impossible;
use std::io;
use std::path::{Path, PathBuf};

/// What went wrong with a study.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The file system refused something.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// What was tried, after "cannot".
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
    /// The folder holds no study.
    #[error("{}: not a study: it has no study.toml", dir.display())]
    NotAStudy {
        /// The folder.
        dir: PathBuf,
    },
    /// `study.toml` or an input file kept in the folder cannot be used.
    #[error("{}: {problem}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong and what would be right.
        problem: String,
    },
    /// The folder holds a study of another configuration.
    #[error(
        "{}: holds a study of another configuration; give another --out, or the same \
         configuration (only the budget may be raised):\n{differences}",
        dir.display()
    )]
    Different {
        /// The folder.
        dir: PathBuf,
        /// One line for each differing field, with both values.
        differences: String,
    },
    /// The study was measured with something else than would go on with it now.
    #[error(
        "{}: was measured with other settings than now:\n{differences}\ngive another --out, or \
         --accept-changed to go on in a new segment (the best design is then taken from that)",
        dir.display()
    )]
    Changed {
        /// The study's folder.
        dir: PathBuf,
        /// One line for each difference, with both values.
        differences: String,
    },
    /// What has changed would decide no evaluation.
    #[error(
        "{}: simulates otherwise than before, and all its {evaluations} evaluations are done:\n\
         {differences}\nraise --budget to measure with that, or give another --out",
        dir.display()
    )]
    Spent {
        /// The study's folder.
        dir: PathBuf,
        /// How many evaluations it has.
        evaluations: u64,
        /// One line for each difference, with both values.
        differences: String,
    },
    /// One line of the journal is damaged.
    #[error(
        "{}: line {line}: {source}; restore the file from a copy, or delete line {line} and \
         all below it to measure them again",
        path.display()
    )]
    Line {
        /// The journal.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What is wrong with it.
        source: LineError,
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
        /// What has happened to it.
        problem: String,
        /// Where everything measured was written to, or why it could not be.
        kept: Result<PathBuf, String>,
    },
    /// The journal is not this study's.
    #[error("{}: not the journal of this study: {problem}", path.display())]
    Foreign {
        /// The journal.
        path: PathBuf,
        /// How that shows.
        problem: String,
    },
    /// The optimizer, started again, proposes other designs than the journal holds.
    #[error(
        "{}: evaluation {index} is of {found}, but this version of the program proposes {proposed}: \
         the journal was written by another version; continue it with that one, or start a new study",
        path.display()
    )]
    Replay {
        /// The journal.
        path: PathBuf,
        /// The evaluation, counted from 0.
        index: u64,
        /// The design in the journal.
        found: String,
        /// The design proposed now.
        proposed: String,
    },
    /// A design of the space cannot be simulated.
    #[error("evaluation {index} of {design} is impossible: {source}; narrow the space")]
    Impossible {
        /// The evaluation, counted from 0.
        index: u64,
        /// The design.
        design: String,
        /// What it sets wrongly.
        source: Impossible,
    },
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

/// What is wrong with one line; the journal adds the file and the line number.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum LineError {
    /// No check, or one that does not fit.
    #[error("damaged: its contents do not fit its `check`")]
    Check,
    /// The check fits, the contents do not.
    #[error("not a line of this program's journals: {0}")]
    Format(String),
    /// Lines are missing, doubled or in the wrong order.
    #[error("evaluation {found} stands where evaluation {expected} belongs")]
    Order {
        /// What the line says.
        found: u64,
        /// What its place in the file says.
        expected: u64,
    },
}
