//! What is printed: standard output, standard error, and what a terminal must not see.

use super::Failure;
use std::fmt::Write as _;
use std::io::{self, Write};

/// Prints to standard output; a reader that has gone away (`| head`) is no error.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(visible(text).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::running(format!("cannot write the output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a value as JSON, one line.
pub fn print_json(value: &serde_json::Value) -> Result<(), Failure> {
    print(&format!("{value}\n"))
}

/// A line on standard error. Where that has gone or is full nobody can be told, and no study
/// ends for it.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{}", visible(text));
}

/// The text with control characters, which move a terminal's cursor or worse, and those that
/// turn the direction of writing as `\u001b`: the escapes of JSON, so that JSON stays what it is.
pub fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        let turns = matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        if turns || (c.is_control() && c != '\n' && c != '\t') {
            // Writing to a String cannot fail.
            let _ = write!(shown, "\\u{:04x}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown_and_json_stays_json() {
        let text = "red \u{1b}[31m, C1 \u{9b}2J, turned \u{202e}, kept \t\n ä";
        let shown = "red \\u001b[31m, C1 \\u009b2J, turned \\u202e, kept \t\n ä";
        assert_eq!(visible(text), shown);
        let value = serde_json::json!({"name": "\u{9b}2J\u{1b}"});
        let line = visible(&value.to_string());
        assert!(!line.chars().any(char::is_control), "{line}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&line).unwrap(), value);
    }
}
