//! Input files: how they are read up to a limit and checked, what may be wrong with them, and the
//! units in them. Inside, every quantity is in SI units; millimetres, newtons per millimetre and
//! degrees appear only in names that say so ([`units`]).
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a defect; what input can reach is an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod files;
pub mod numbers;
mod place;
pub mod shipped;
pub mod units;

pub use place::{Fault, Place, Placed};
use serde::de::DeserializeOwned;
use std::sync::atomic::{AtomicU64, Ordering};
use toml::Spanned;
use toml::de::DeTable;

/// Error of an input file: not TOML of its shape, or a value that cannot be used.
#[derive(Debug, Clone, thiserror::Error, PartialEq)]
pub enum InputError {
    /// Not TOML, an unknown key or a missing field; the text names the line.
    #[error("{file}: {message}")]
    Syntax {
        /// The file as given.
        file: String,
        /// The line, if the parser knows it.
        line: Option<usize>,
        /// The parser's message, with line and column.
        message: String,
    },
    /// A field with a value that cannot be used.
    #[error("{file}: {key}: {problem}")]
    Value {
        /// The file as given.
        file: String,
        /// Path of the field in the file.
        key: String,
        /// The problem, and what would be right.
        problem: String,
    },
}

/// Largest size of any number in a file: beyond it the unit is wrong, and sums and products
/// would leave what floating point holds.
const LARGEST: f64 = 1e9;
/// Smallest number where one must be above 0.
const SMALLEST: f64 = 1e-9;
/// Longest length and largest coordinate, mm.
const LONGEST_MM: f64 = 1000.0;

impl Placed for InputError {
    fn place(&self) -> Place {
        match self {
            InputError::Syntax { file, line, .. } => {
                Place { line: *line, ..Place::file(file.clone()) }
            }
            InputError::Value { file, key, .. } => Place::file(file.clone()).key(key),
        }
    }
}

/// The error of a file that is not TOML, or not of the shape asked for; `text` is where it was read.
pub fn syntax(file: &str, text: &str, error: &toml::de::Error) -> InputError {
    let before = error.span().and_then(|span| text.get(..span.start));
    InputError::Syntax {
        file: file.to_owned(),
        line: before.map(|before| 1 + before.matches('\n').count()),
        message: error.to_string().trim_end().to_owned() + &suggestion(error.message()),
    }
}

/// Returns the accepted word nearest to the one that serde refuses, as a question; else nothing.
fn suggestion(message: &str) -> String {
    let mut words = message.split('`').skip(1).step_by(2);
    let (Some(given), accepted) = (words.next(), words.collect::<Vec<_>>()) else {
        return String::new();
    };
    let near = shipped::nearest(given, &accepted).filter(|_| message.starts_with("unknown "));
    near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default()
}

/// A TOML text that was parsed once, from which typed values are read.
#[derive(Debug, Clone)]
pub struct Document<'a> {
    text: &'a str,
    file: &'a str,
    tree: Spanned<DeTable<'a>>,
}

/// Number of texts that were parsed.
static PARSED: AtomicU64 = AtomicU64::new(0);

/// Returns how many TOML texts were parsed since the process began.
pub fn parsed() -> u64 {
    PARSED.load(Ordering::Relaxed)
}

impl<'a> Document<'a> {
    /// Parses TOML; `file` is named in errors.
    ///
    /// # Errors
    /// If the text is not TOML.
    pub fn parse(text: &'a str, file: &'a str) -> Result<Self, InputError> {
        PARSED.fetch_add(1, Ordering::Relaxed);
        let tree = DeTable::parse(text).map_err(|error| syntax(file, text, &error))?;
        Ok(Document { text, file, tree })
    }

    /// Returns the file as given.
    pub fn file(&self) -> &str {
        self.file
    }

    /// Reads a value of the whole document.
    ///
    /// # Errors
    /// If the document is not of this shape, or has a control character.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        let found = self.of()?;
        match control_character(&self.of()?) {
            Some(key) => {
                Check { file: self.file }.fail(&key, "has a control character, such as \\u001b")
            }
            None => Ok(found),
        }
    }

    fn of<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        T::deserialize(toml::de::Deserializer::from(self.tree.clone())).map_err(|mut error| {
            error.set_input(Some(self.text));
            syntax(self.file, self.text, &error)
        })
    }
}

/// Reads TOML; `file` is named in errors.
///
/// # Errors
/// If the text is not TOML of this shape, or has a control character.
pub fn read<T: DeserializeOwned>(text: &str, file: &str) -> Result<T, InputError> {
    Document::parse(text, file)?.read()
}

/// The key of a text with a control character in it: such texts reach terminals and pages.
pub fn control_character(table: &toml::Table) -> Option<String> {
    fn within(value: &toml::Value) -> bool {
        match value {
            toml::Value::String(text) => text.chars().any(|c| c.is_control() && c != '\n'),
            toml::Value::Array(items) => items.iter().any(within),
            toml::Value::Table(table) => control_character(table).is_some(),
            _ => false,
        }
    }
    let plain = |key: &str| !key.chars().any(char::is_control);
    let found = table.iter().find(|(key, value)| within(value) || !plain(key))?;
    Some(if plain(found.0) { found.0.clone() } else { "a key".to_owned() })
}

/// Line of CSV, from 1, in which a quoted cell runs over the end of the line: the reader would take the
/// lines below for a part of it. Lines that begin with `#` are comments.
pub fn unclosed_quote(text: &str) -> Option<usize> {
    let runs_over = |line: &str| {
        // A quotation mark opens a cell only at its beginning; twice, it stands for itself.
        let (mut quoted, mut opens) = (false, true);
        for c in line.chars() {
            (quoted, opens) = match c {
                '"' if quoted => (false, true),
                '"' => (opens, false),
                _ => (quoted, !quoted && c == ','),
            };
        }
        quoted
    };
    text.lines().position(|line| !line.starts_with('#') && runs_over(line)).map(|at| at + 1)
}

/// Problem of a line that [`unclosed_quote`] finds.
pub const UNCLOSED: &str = "a quoted cell runs over the end of the line; close its quotation mark \
                            there (a mark within a quoted cell is written twice)";

/// A number as messages show it: never hundreds of digits.
pub fn shown(value: f64) -> String {
    let plain = value == 0.0 || (1e-6..1e12).contains(&value.abs()) || !value.is_finite();
    if plain { value.to_string() } else { format!("{value:e}") }
}

/// Checks the values of one file.
#[derive(Debug, Clone, Copy)]
pub struct Check<'a> {
    /// The file as given.
    pub file: &'a str,
}

impl Check<'_> {
    /// Refuses a field.
    ///
    /// # Errors
    /// Always: with this problem of the field.
    pub fn fail<T>(&self, key: &str, problem: impl Into<String>) -> Result<T, InputError> {
        Err(InputError::Value {
            file: self.file.to_owned(),
            key: key.to_owned(),
            problem: problem.into(),
        })
    }

    /// The value, if it fits; `must` says what would.
    pub fn require(
        &self,
        key: &str,
        value: f64,
        fits: bool,
        must: &str,
    ) -> Result<f64, InputError> {
        if fits {
            Ok(value)
        } else {
            self.fail(key, format!("is {}; it must {must}", shown(value)))
        }
    }

    /// The values, if each passes a check of one value, such as [`Check::finite`].
    ///
    /// # Errors
    /// Error of the first value that fails the check.
    pub fn each<const N: usize>(
        &self,
        key: &str,
        values: [f64; N],
        one: fn(&Self, &str, f64) -> Result<f64, InputError>,
    ) -> Result<[f64; N], InputError> {
        values.iter().try_for_each(|&value| one(self, key, value).map(drop))?;
        Ok(values)
    }

    /// The value, if it is finite and not beyond 1e9.
    ///
    /// # Errors
    /// If it is not.
    pub fn finite(&self, key: &str, value: f64) -> Result<f64, InputError> {
        // Written so that a NaN is outside.
        let fits = value.abs() <= LARGEST;
        self.require(key, value, fits, "be a finite number of size 1e9 or less")
    }

    /// The value, if it is above 0: from 1e-9 to 1e9.
    ///
    /// # Errors
    /// If it is not.
    pub fn positive(&self, key: &str, value: f64) -> Result<f64, InputError> {
        let fits = (SMALLEST..=LARGEST).contains(&value);
        self.require(key, value, fits, "be a finite number above 0, 1e-9 to 1e9")
    }

    /// The value, if it is not below 0 and not beyond 1e9.
    ///
    /// # Errors
    /// If it is not.
    pub fn not_negative(&self, key: &str, value: f64) -> Result<f64, InputError> {
        let fits = (0.0..=LARGEST).contains(&value);
        self.require(key, value, fits, "be a finite number, 0 or above, 1e9 at most")
    }

    /// The value, if it can be a coordinate or a difference of two, mm.
    ///
    /// # Errors
    /// If it is not finite, or longer than 1 m.
    pub fn distance(&self, key: &str, mm: f64) -> Result<f64, InputError> {
        let fits = self.finite(key, mm)?.abs() <= LONGEST_MM;
        self.require(key, mm, fits, &format!("lie in -{LONGEST_MM} .. {LONGEST_MM} (mm)"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Friction {
        #[expect(dead_code, reason = "only its name is read")]
        plug_socket: f64,
    }

    #[test]
    fn an_unknown_key_is_named_with_its_line_and_the_nearest_key() {
        let error = read::<Friction>("\nplug_sockt = 0.3", "task.toml").unwrap_err();
        assert_eq!(error.place().line, Some(2));
        let text = error.to_string();
        assert!(text.ends_with("expected `plug_socket`; did you mean `plug_socket`?"), "{text}");
        assert!(
            !read::<Friction>("other = 0.3", "task.toml").unwrap_err().to_string().contains("mean")
        );
    }
}
