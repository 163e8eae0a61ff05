//! Layout of text output: labelled lines, wrapped to the width of a terminal.

use report::answer::lines::Line;
use std::path::PathBuf;

/// Assumed width of a terminal, columns.
const COLUMNS: usize = 80;
/// Column in which the text of a line begins, after its label.
const INDENT: usize = 14;

/// Wraps lines to 80 columns and indents the continuation to the column of the text. Breaks after a comma or
/// semicolon or before a bracket if there is one in the second half of the line, else at a space.
pub fn wrapped(text: &str) -> String {
    text.split_inclusive('\n').map(wrapped_line).collect()
}

fn wrapped_line(line: &str) -> String {
    // The next command is not wrapped, so that it can be copied.
    if line.trim_end().chars().count() <= COLUMNS || line.starts_with("next  ") {
        return line.to_owned();
    }
    let spaces = || {
        let places = line.char_indices().take(COLUMNS + 1);
        places.filter(|&(at, c)| c == ' ' && at > INDENT).map(|(at, _)| at)
    };
    let clause = |at: &usize| {
        let (before, after) = line.split_at(*at);
        *at > COLUMNS / 2 && (before.ends_with([',', ';']) || after.starts_with(" ("))
    };
    let Some(end) = spaces().filter(clause).last().or(spaces().last()) else {
        return line.to_owned();
    };
    let (first, rest) = line.split_at(end);
    let rest = wrapped_line(&format!("{:INDENT$}{}", "", rest.trim_start()));
    format!("{first}\n{rest}")
}

/// Returns a line for each file that was written.
pub fn wrote<'a>(files: impl IntoIterator<Item = &'a PathBuf>) -> String {
    files.into_iter().map(|file| format!("wrote         {}\n", file.display())).collect()
}

/// Returns pairs of label and text as lines, aligned in two columns.
pub fn lines(lines: impl IntoIterator<Item = Line>) -> String {
    lines.into_iter().map(|(name, text)| format!("{name:<13} {text}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_go_on_below_where_they_begin() {
        let short = "range         3.5 mm\n";
        let design =
            "  least force infill density 10 %, infill direction 29°: 79.2 N (evaluation 1176)\n";
        let shape = "best design   material modulus 0.5 GPa, notch pad 11 mm, outline back radius 33 mm, \
                     outline length 64.8 mm, ribs thickness 0.38 mm, skin thickness 0.7 mm (evaluation 9)\n";
        let path = format!("study         {}\n", "x".repeat(100));
        let next = format!("next          optimize task tune {} --robot rigid\n", "x".repeat(80));
        assert_eq!(wrapped(short), short);
        assert_eq!(wrapped(&path), path, "nothing to break it at");
        assert_eq!(wrapped(&next), next, "a command to copy");
        let broken = "  least force infill density 10 %, infill direction 29°: 79.2 N\n              (evaluation 1176)\n";
        assert_eq!(wrapped(&format!("{short}{design}")), format!("{short}{broken}"));
        let lines = wrapped(shape);
        assert!(lines.lines().all(|line| line.chars().count() <= COLUMNS), "{lines}");
        assert_eq!(
            lines.split_whitespace().collect::<Vec<_>>(),
            shape.split_whitespace().collect::<Vec<_>>()
        );
        assert!(lines.lines().skip(1).all(|line| line.starts_with(&" ".repeat(INDENT))), "{lines}");
    }
}
