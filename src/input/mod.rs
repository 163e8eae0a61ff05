//! Input files: how they are read, and what may be wrong with them.

pub mod arm;
pub mod experiments;
pub mod finger;
pub mod printed;
pub mod published;
pub mod robot;
pub mod shipped;
pub mod space;
pub mod stiffness;
pub mod task;

use serde::de::DeserializeOwned;

/// What is wrong with a task, space or robot file.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum InputError {
    /// Not TOML, an unknown key or a missing field; the text names the line.
    #[error("{file}: {message}")]
    Syntax {
        /// The file as given.
        file: String,
        /// The parser's message, with line and column.
        message: String,
    },
    /// A field with a value that cannot be used.
    #[error("{file}: {key}: {problem}")]
    Value {
        /// The file as given.
        file: String,
        /// The field.
        key: String,
        /// What is wrong and what would be right.
        problem: String,
    },
}

/// Reads TOML; `file` is named in errors.
pub(crate) fn read<T: DeserializeOwned>(text: &str, file: &str) -> Result<T, InputError> {
    toml::from_str(text).map_err(|error| InputError::Syntax {
        file: file.to_owned(),
        message: error.to_string().trim_end().to_owned(),
    })
}

/// Checks the values of one file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Check<'a> {
    /// The file as given.
    pub file: &'a str,
}

impl Check<'_> {
    /// The error of a field.
    pub fn fail<T>(&self, key: &str, problem: impl Into<String>) -> Result<T, InputError> {
        Err(InputError::Value {
            file: self.file.to_owned(),
            key: key.to_owned(),
            problem: problem.into(),
        })
    }

    /// The value, if it is finite.
    pub fn finite(&self, key: &str, value: f64) -> Result<f64, InputError> {
        if value.is_finite() {
            return Ok(value);
        }
        self.fail(key, format!("is {value}; it must be a finite number"))
    }

    /// The value, if it is finite and above 0.
    pub fn positive(&self, key: &str, value: f64) -> Result<f64, InputError> {
        if value.is_finite() && value > 0.0 {
            return Ok(value);
        }
        self.fail(key, format!("is {value}; it must be a finite number above 0"))
    }

    /// The value, if it is finite and not below 0.
    pub fn not_negative(&self, key: &str, value: f64) -> Result<f64, InputError> {
        if value.is_finite() && value >= 0.0 {
            return Ok(value);
        }
        self.fail(key, format!("is {value}; it must be a finite number, 0 or above"))
    }
}
