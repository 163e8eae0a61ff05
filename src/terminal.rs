//! Standard output and standard error: control characters are escaped; on a terminal labels are coloured.

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

/// Column in which the text of a line begins, after its label: `ends          jammed`.
const INDENT: usize = 14;

/// Returns text with coloured labels, `error:` and `warning:`.
fn coloured(text: &str) -> String {
    text.split_inclusive('\n').map(coloured_line).collect()
}

fn coloured_line(line: &str) -> String {
    const RED: Style = AnsiColor::Red.on_default().bold();
    const YELLOW: Style = AnsiColor::Yellow.on_default().bold();
    const CYAN: Style = AnsiColor::Cyan.on_default();
    let name = || {
        let (name, rest) = line.split_at_checked(INDENT)?;
        let gap = name.ends_with(' ') && !rest.starts_with([' ', '\n']);
        let words = name.starts_with(|c: char| c.is_lowercase()) && !name.contains([':', '=', ',']);
        // A label has single spaces between its words; two spaces are part of a table.
        (gap && words && !name.trim_end().contains("  ")).then_some(INDENT)
    };
    let (end, style) = match line {
        _ if line.starts_with("error:") => (6, RED),
        _ if line.starts_with("warning:") => (8, YELLOW),
        _ => match name() {
            Some(end) if line.starts_with("force ") || line.starts_with("warning ") => {
                (end, YELLOW)
            }
            Some(end) => (end, CYAN),
            None => return line.to_owned(),
        },
    };
    let (name, rest) = line.split_at(end);
    format!("{style}{name}{style:#}{rest}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_lines_are_coloured_and_text_is_not() {
        let plain = [
            "Print the finger with 10 % infill",
            "[plug]",
            "mass_g = 5.0  # grams",
            "{\"a\": 1}",
            "",
        ];
        for text in plain {
            assert_eq!(coloured(text), text);
        }
        assert_eq!(coloured("ends          jammed\n"), "\u{1b}[36mends          \u{1b}[0mjammed\n");
        assert!(coloured("error: x").starts_with("\u{1b}[1m\u{1b}[31merror:\u{1b}[0m"));
        assert!(coloured("warning       measure it").starts_with("\u{1b}[1m\u{1b}[33m"));
    }
}
