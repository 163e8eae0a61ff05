//! Standard output and standard error: control characters are escaped; on a terminal errors and warnings are coloured.

use crate::Failure;
use clap::builder::styling::{AnsiColor, Style};
use input::files::visible;
use std::io::{self, IsTerminal, Write};

/// Prints to standard output; a closed pipe (`| head`) is not an error.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(shown(text, &out).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::running(format!("cannot write the output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Returns text for a stream: control characters escaped (a carriage return would overwrite the line), and coloured if
/// the stream supports it.
fn shown(text: &str, stream: &impl IsTerminal) -> String {
    let text = visible(text).replace('\r', "\\r");
    if takes_colours(stream) { coloured(&text) } else { text }
}

/// Writes a line on standard error; a failure is ignored, so that it does not end a study.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{}", shown(text, &io::stderr()));
}

/// Returns whether a stream supports colours: a terminal, unless `NO_COLOR` is set or `TERM` is `dumb`.
fn takes_colours(stream: &impl IsTerminal) -> bool {
    let set = |name| std::env::var_os(name).filter(|value| !value.is_empty());
    let dumb = || set("TERM").is_some_and(|term| term == "dumb");
    stream.is_terminal() && set("NO_COLOR").is_none() && !dumb()
}

const RED: Style = AnsiColor::Red.on_default().bold();
const YELLOW: Style = AnsiColor::Yellow.on_default().bold();
/// Labels of errors and warnings at the beginning of a line, with their colours.
const LABELS: [(&str, Style); 4] =
    [("error:", RED), ("warning:", YELLOW), ("warning ", YELLOW), ("force ", YELLOW)];

/// Returns text with coloured labels of errors and warnings.
fn coloured(text: &str) -> String {
    let line = |line: &str| {
        let label = LABELS.into_iter().find_map(|(label, style)| {
            Some(format!("{style}{label}{style:#}{}", line.strip_prefix(label)?))
        });
        label.unwrap_or_else(|| line.to_owned())
    };
    text.split_inclusive('\n').map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_and_warnings_are_coloured_and_text_is_not() {
        for text in ["Print the finger with 10 % infill", "ends          jammed\n", ""] {
            assert_eq!(coloured(text), text);
        }
        assert!(coloured("error: x").starts_with("\u{1b}[1m\u{1b}[31merror:\u{1b}[0m"));
        assert!(coloured("warning       measure it").starts_with("\u{1b}[1m\u{1b}[33m"));
    }
}
