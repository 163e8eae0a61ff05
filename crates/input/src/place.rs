//! Place of an error in the input.

use std::fmt;

/// Place of an error in the input, as far as known.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Place {
    /// File name as given by the user.
    pub file: Option<String>,
    /// Line of the file, counted from 1.
    pub line: Option<usize>,
    /// Path of the field in a TOML file, column of a CSV file, or name of the option in Python.
    pub key: Option<String>,
}

/// Error with a place.
pub trait Placed {
    /// Returns the place of the error.
    fn place(&self) -> Place;
}

/// Error of the input with its place: invalid syntax, an unknown or missing field, or an invalid value.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct InputError {
    /// Place of the error; at least one of its fields is known.
    pub place: Place,
    /// The problem, and what is accepted.
    pub problem: String,
}

/// Error of a request (the options of a command); its text already includes the place.
#[derive(Debug, thiserror::Error)]
#[error("{text}")]
pub struct RequestError {
    /// Place of the error, as far as known.
    pub place: Place,
    /// The error message.
    pub text: String,
}

impl Place {
    /// Returns the place of a file.
    pub fn file(file: impl Into<String>) -> Self {
        Place { file: Some(file.into()), ..Place::default() }
    }

    /// Returns the place of the command-line option at the beginning of a message, by its name in Python: `seed_count`
    /// for `--seed-count`. The place is empty if the message does not begin with an option.
    pub fn option(text: &str) -> Self {
        let name = text.strip_prefix("--").unwrap_or_default();
        let end = name.find(|c: char| !c.is_ascii_lowercase() && c != '-').unwrap_or(name.len());
        Place::default().key(&name[..end].replace('-', "_"))
    }

    /// Returns the place with a field or option; without one if `key` is empty.
    pub fn key(self, key: &str) -> Self {
        Place { key: (!key.is_empty()).then(|| key.to_owned()), ..self }
    }

    /// Returns the place with a line, counted from 1.
    pub fn line(self, line: usize) -> Self {
        Place { line: Some(line), ..self }
    }

    /// Returns the error of a problem at this place.
    pub fn fault(self, problem: impl Into<String>) -> InputError {
        InputError { place: self, problem: problem.into() }
    }
}

impl Placed for InputError {
    fn place(&self) -> Place {
        self.place.clone().key(self.place.key.as_deref().unwrap_or_default())
    }
}

impl Placed for RequestError {
    fn place(&self) -> Place {
        self.place.clone()
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Messages of the TOML parser begin with the line.
        let line = self.place.line.filter(|_| !self.problem.starts_with("TOML parse error"));
        write!(f, "{}: {}", Place { line, ..self.place.clone() }, self.problem)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = self.line.map(|line| format!("line {line}"));
        let parts = [&self.file, &line, &self.key].into_iter().flatten();
        f.write_str(&parts.map(String::as_str).collect::<Vec<_>>().join(": "))
    }
}
