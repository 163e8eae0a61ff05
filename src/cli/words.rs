//! What is printed of an evaluation.

use crate::answer::words::{self, ends_mm, mm, span};
use crate::study::ByRibs;
use input::units::N_PER_MM;
use insertion::evaluation::{Evaluation, OffsetStep, grid_mm};
use insertion::outcome::Outcome;
use insertion::surrogate::Prediction;
use std::fmt::Write;

/// Columns of a terminal.
const COLUMNS: usize = 80;
/// Where what a line says begins, after its name.
const INDENT: usize = 14;

/// Lines that fit a terminal: a longer one goes on below where what it says begins. It is broken after
/// a comma or before a bracket if there is one in its second half, else at a space.
pub fn wrapped(text: &str) -> String {
    text.split_inclusive('\n').map(wrapped_line).collect()
}

fn wrapped_line(line: &str) -> String {
    if line.trim_end().chars().count() <= COLUMNS {
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

/// The window of an evaluation and what ended it.
pub fn window(evaluation: &Evaluation) -> String {
    let window = &evaluation.window;
    if window.nominal != Outcome::Inserted {
        return format!(
            "window        none: the nominal start ends with {}",
            end(Some(window.nominal))
        );
    }
    format!(
        "window        {} mm\nends          {} below, {} above",
        span(ends_mm(window)),
        end(window.end_negative),
        end(window.end_positive)
    )
}

fn end(outcome: Option<Outcome>) -> &'static str {
    outcome.map_or("limit of the search", Outcome::label)
}

/// A difference of numbers with one decimal, without the noise of the subtraction.
pub fn rounded(mm: f64) -> f64 {
    (mm * 1e6).round() / 1e6
}

/// Predicted stiffness, its uncertainty, and whether it is an extrapolation; two lines.
pub fn stiffness(prediction: &Prediction) -> String {
    let mut text = String::from("stiffness    ");
    for (axis, estimate) in
        [("compliance", prediction.compliance), ("assembly", prediction.assembly)]
    {
        let (mean, sd) = (estimate.mean / N_PER_MM, estimate.sd / N_PER_MM);
        // Writing to a String cannot fail.
        let _ = write!(text, " {axis} {mean:.2} ± {sd:.2} N/mm,");
    }
    text.pop();
    text.push_str("\n              ");
    if prediction.inside_hull() {
        text.push_str("inside the measured designs");
    } else {
        let distance = prediction.hull_distance;
        let _ = write!(text, "{distance:.2} spans OUTSIDE the measured designs");
    }
    text
}

/// Success rate and robust range, a line each, as far as they were measured.
pub fn drawn_text(evaluation: &Evaluation) -> Vec<String> {
    let success = evaluation.success.as_ref().map(|success| {
        let [rate, failures] = words::success(success);
        format!("success rate  {rate}\n              failures {failures}")
    });
    let robust = evaluation.robust.as_ref();
    let robust = robust.map(|robust| format!("robust range  {}", words::robust(robust)));
    success.into_iter().chain(robust).collect()
}

/// What the finger tolerates with springs computed from its ribs, a line a task, each ended.
pub fn by_ribs(found: &ByRibs) -> Vec<String> {
    let line = |said: String| format!("from its ribs {said}\n");
    let tasks = match found {
        ByRibs::Refused(why) => return vec![line(why.clone())],
        ByRibs::Measured(tasks) => tasks,
    };
    tasks.iter().map(|evaluation| line(tolerated(evaluation))).collect()
}

/// Range and window in one line, and from where they count.
fn tolerated(Evaluation { window, taught, .. }: &Evaluation) -> String {
    if window.nominal != Outcome::Inserted {
        return format!("none: its nominal start ends with {}", window.nominal.label());
    }
    let start = words::taught(*taught, "");
    let (range, ends) = (mm(window.range_mm()), span(ends_mm(window)));
    format!("{range} ({ends}{start}); --finger-model computed")
}

/// Where a taught start came to lie; `None` if it was not taught.
pub fn taught(steps: Option<OffsetStep>) -> Option<String> {
    let mm = grid_mm(steps?);
    Some(format!("start         taught: {mm:+.1} mm from that of the task file"))
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
        assert_eq!(wrapped(short), short);
        assert_eq!(wrapped(&path), path, "nothing to break it at");
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
