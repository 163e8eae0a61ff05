//! What is wrong with a measurement file.

use super::Experiment;
use input::shipped::nearest;
use std::fmt;

/// One thing that is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Line in the file, from 1.
    pub line: u64,
    /// The column, as in the header.
    pub column: String,
    /// What is wrong and what would be right.
    pub words: String,
}

/// All that is wrong with one file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct Problems {
    file: String,
    problems: Vec<Problem>,
}

impl Problem {
    pub(super) fn new(line: u64, column: &str, words: impl Into<String>) -> Self {
        Problem { line, column: column.to_owned(), words: words.into() }
    }
}

impl Problems {
    pub(super) fn new(file: &str, problems: Vec<Problem>) -> Self {
        Problems { file: file.to_owned(), problems }
    }

    pub(super) fn one(file: &str, problem: Problem) -> Self {
        Problems::new(file, vec![problem])
    }

    /// Not a table.
    pub(super) fn syntax(file: &str, error: &csv::Error) -> Self {
        let line = error.position().map_or(1, csv::Position::line);
        let words = match error.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                format!("has {len} cells where the header has {expected_len}")
            }
            _ => error.to_string(),
        };
        Problems::one(file, Problem::new(line, "", words))
    }

    /// Each of them, in the order of the lines.
    pub fn each(&self) -> &[Problem] {
        &self.problems
    }
}

impl fmt::Display for Problems {
    /// `file: line 3: range_mm: what is wrong`, a line each.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = |Problem { line, column, words }: &Problem| {
            let column = if column.is_empty() { String::new() } else { format!("{column}: ") };
            format!("{}: line {line}: {column}{words}", self.file)
        };
        f.write_str(&self.problems.iter().map(line).collect::<Vec<_>>().join("\n"))
    }
}

/// The first line of the experiment's task that nobody knows.
pub(super) fn unknown_task(experiment: &Experiment, known: &[&str]) -> Problem {
    let name = &experiment.task;
    let hint =
        nearest(name, known).map_or(String::new(), |near| format!(" (did you mean `{near}`?)"));
    let words = format!(
        "no task is called `{name}`{hint}; there are {}, or name your own by --task FILE.toml",
        known.join(", ")
    );
    Problem::new(experiment.line, "task", words)
}
