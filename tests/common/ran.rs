//! Output of a finished command; shared by the tests of `optimize` and of `lab`.
#![allow(dead_code, reason = "each test file uses its own part of this")]

use std::path::Path;
use std::process::{Command, Output};

/// Output of a finished command.
pub struct Ran {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Ran {
    /// Fails unless the exit code is this and standard error holds all of `parts`.
    pub fn fails(&self, code: i32, parts: &[&str]) {
        assert_eq!(self.code, Some(code), "{}{}", self.stdout, self.stderr);
        for part in parts {
            assert!(self.stderr.contains(part), "`{part}` is not in: {}", self.stderr);
        }
    }

    /// Fails unless the command succeeded; gives its standard output.
    pub fn succeeds(&self) -> &str {
        assert_eq!(self.code, Some(0), "{}{}", self.stdout, self.stderr);
        &self.stdout
    }

    /// Fails unless the command succeeded and its standard output holds all of `parts`.
    pub fn says(&self, parts: &[&str]) {
        for part in parts {
            assert!(self.succeeds().contains(part), "`{part}` is not in: {}", self.stdout);
        }
    }

    /// The same, of standard output without the ends of its lines, at which long ones are wrapped.
    pub fn says_in_any_lines(&self, part: &str) {
        let words: Vec<&str> = self.succeeds().split_whitespace().collect();
        assert!(words.join(" ").contains(part), "`{part}` is not in: {}", self.stdout);
    }

    /// Standard output as JSON.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(self.succeeds()).expect("JSON on standard output")
    }
}

/// Runs a command to its end.
pub fn run(command: &mut Command) -> Ran {
    let Output { status, stdout, stderr } = command.output().expect("the command starts");
    Ran {
        code: status.code(),
        stdout: String::from_utf8(stdout).expect("UTF-8"),
        stderr: String::from_utf8(stderr).expect("UTF-8"),
    }
}

/// A text file that must be there.
pub fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
