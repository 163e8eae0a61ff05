//! What a line can be refused for.

use super::message::{LARGEST_BATCH, LONGEST_LINE, MOST_NUMBERS};
use crate::{OptimizerKind, UnknownOptimizer};

/// Why a line was refused; nothing was changed by it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AskTellError {
    /// Not JSON, or not of the form its kind of line has.
    #[error("{0}")]
    Syntax(String),
    /// A JSON value that is none of the three kinds of line.
    #[error(
        "not a known line; a line is {{\"parameters\":[..],..}}, {{\"ask\":n}} or {{\"tell\":[..]}}"
    )]
    UnknownLine,
    /// An ask or a tell before the parameters.
    #[error(
        "the first line must be {{\"parameters\":[..],\"optimizer\":..,\"seed\":..,\"direction\":..}}"
    )]
    NotBegun,
    /// The parameters a second time.
    #[error("the parameters are given already; for others start another process")]
    BegunAlready,
    /// No parameters.
    #[error("parameters: is empty; there must be at least one")]
    NoParameters,
    /// A parameter that cannot be used.
    #[error("parameter `{name}`: {problem}")]
    Parameter {
        /// Its name as given.
        name: String,
        /// What is wrong and what would be right.
        problem: &'static str,
    },
    /// The optimizer's name.
    #[error("optimizer: {0}")]
    Optimizer(#[from] UnknownOptimizer),
    /// A batch of no points, or of too many.
    #[error("batch: {0} is not between 1 and {LARGEST_BATCH}")]
    Batch(usize),
    /// Too many points at once.
    #[error("ask: {0} is more than {LARGEST_BATCH}, the most that can be asked at once")]
    AskedTooMany(usize),
    /// More parameters than an optimizer copes with.
    #[error("parameters: there are {found}; {optimizer} takes {most} at most")]
    TooManyParameters {
        /// How many.
        found: usize,
        /// The optimizer.
        optimizer: OptimizerKind,
        /// How many it takes.
        most: usize,
    },
    /// More numbers at once than are handed out.
    #[error(
        "{points} points of {parameters} parameters are more than {MOST_NUMBERS} numbers, the \
         most at once"
    )]
    TooManyNumbers {
        /// How many points.
        points: usize,
        /// Of how many parameters.
        parameters: usize,
    },
    /// A line that is not read to its end.
    #[error("the line is longer than {LONGEST_LINE} bytes, the most of a line")]
    TooLong,
    /// A point that was never asked, with values that it cannot have.
    #[error("tell: `{name}` {problem}")]
    KnownValues {
        /// A parameter, or what was taken for one.
        name: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// A point that was never asked, told twice or asked after all.
    #[error("tell: a point is told by its values though it {0}")]
    KnownAlready(String),
    /// Asked while the optimizer waits for values.
    #[error("ask: tell the values of {} first (null for one that failed)", list(.0))]
    Untold(Vec<u64>),
    /// An id that was not asked.
    #[error("tell: id {0} was not asked")]
    UnknownId(u64),
    /// An id that has its value, or that stands twice in the line.
    #[error("tell: id {0} is told twice; each id is told once")]
    ToldTwice(u64),
}

/// `id 3`, or `ids 3, 4 and 17 more`.
fn list(ids: &[u64]) -> String {
    const SHOWN: usize = 8;
    let shown: Vec<String> = ids.iter().take(SHOWN).map(u64::to_string).collect();
    let (word, shown) = (if ids.len() == 1 { "id" } else { "ids" }, shown.join(", "));
    match ids.len().saturating_sub(SHOWN) {
        0 => format!("{word} {shown}"),
        more => format!("{word} {shown} and {more} more"),
    }
}
