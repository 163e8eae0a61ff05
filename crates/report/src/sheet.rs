//! Printable A4 sheet for measuring windows by hand: instructions and boxes to fill in.

use super::elements::{data_url, styled};
use input::units::{DEG, MM};
use insertion::trial::{PROBE_FORCE, PROBE_SLIDES, PROBE_SPEED, PROBE_STROKE};
use insertion::{Outcome, Task};
use maud::{Markup, html};

/// Number of boxes to fill in per row.
const BOXES: i32 = 12;
/// Description of a successful insertion, then of each failure class, for the user to classify attempts.
const MEANINGS: [&str; 5] = [
    "seated, upright, held",
    "the plug slips out of the fingers before it is at the socket (drawn as that begins)",
    "the leading edge is not in the opening when the search ends",
    "it is in the opening, and is not seated",
    "the plug leaves the fingers, or slips in them, in search or push",
];

/// Simulated example of an outcome.
#[derive(Debug, Clone)]
pub struct Picture {
    /// The outcome.
    pub outcome: Outcome,
    /// Drawing of plug, fingertips and socket at the end, viewed along x.
    pub svg: String,
    /// Name of the task.
    pub task: String,
}

/// Returns the sheet: instructions for the task, with a picture of each outcome, then a page for
/// each finger (infill density, percent, and direction, degrees). `name` is the task as given to
/// commands.
pub fn page(task: &Task, name: &str, fingers: &[(f64, f64)], pictures: &[Picture]) -> String {
    let body = html! {
        section { (instructions(task, pictures)) }
        @for &finger in fingers { section { (boxes(task, name, finger)) } }
    };
    styled(&format!("Measuring sheet: {}", task.name), include_str!("sheet.css"), body)
}

fn instructions(task: &Task, pictures: &[Picture]) -> Markup {
    let [x, y, z] = task.strategy.start.map(|place| format!("{:.1}", place / MM));
    let (depth, tilt) = (task.success.depth / MM, task.success.tilt / DEG);
    // z = 0 is below the top of a socket with a recess.
    let corners = task.socket.iter().flat_map(|part| part.solid.corners());
    let top = corners.map(|corner| corner.z / MM).fold(0.0, f64::max);
    html! {
        h1 { "Measuring sheet: " (task.name) }
        p { (task.description) }
        p.line { "Date" i {} "Robot" i {} "Measured by" i {} "Socket no." i {} "Force limit N" i {} }
        h2 { "Where to teach" }
        p { "Limit the robot's force before the first insertion. According to the task file, the search begins with the "
            "TCP at x " (x) ", y " (y) ", z " (z) " mm from the middle of the socket's opening (z out of it), the plug "
            "tilted by " (format!("{:.1}", task.strategy.tilt / DEG)) "°. Near there, teach a start from which the plug "
            "inserts three times out of three: this is 0. Shifts are along y, in which the jaws close; + is away from "
            "the wall that the search moves to. Keep grasp, speeds, plug and socket the same for all fingers." }
        (probe(task, top))
        h2 { "Which starts, in which order" }
        ol {
            li { "From 0 in steps of 0.5 mm to -, until two neighbouring starts fail; then the same to +." }
            li { "A start that fails while the next one inserts: try it again. If it fails again, it is a gap: note it, and go on." }
            li { "Near each end, in steps of 0.1 mm: first the middle between the last start that inserted and the first "
                 "that failed, then where the outcome is least certain, until about half of the attempts insert at one "
                 "start or between two neighbours; at least 8 attempts. That start is the end." }
        }
        h2 { "What counts as inserted" }
        p { "At rest after the push the tip is at least " (format!("{:.1}", depth + top)) " mm below the socket's top, the plug leans by "
            "at most " (format!("{tilt:.1}")) "°, and both fingers still hold it. Write + for inserted, else the class:" }
        div.pictures { @for picture in pictures { (outcome_figure(picture)) } }
    }
}

/// Returns the instructions for the friction probe: the plug is pressed on a flat face and slides along it. In a recess
/// of this depth, mm, it cannot: a plate with room for plug and stroke replaces the socket.
fn probe(task: &Task, recess_mm: f64) -> Markup {
    let [stroke, speed] = [PROBE_STROKE, PROBE_SPEED].map(|length| length / MM);
    let long_mm = (stroke + (task.opening[1][1] - task.opening[1][0]) / MM).ceil();
    let face = match recess_mm > 0.0 {
        true => &format!("a flat plate of the socket's material, {long_mm} mm long or more in y"),
        false => "the flat face beside the opening",
    };
    html! {
        h2 { "First the probe, once with each finger" }
        p { "Hold the plug upright over " (face) ". Start a log of time, force, pose and commanded "
            "pose, 125 Hz or more, while the plug is in the air. Press it against the face with " (PROBE_FORCE) " N and slide "
            "it " (stroke) " mm along y, back and forth, " (PROBE_SLIDES / 2) " times, at " (speed) " mm/s. Stop if it catches. "
            "Lift it off, then end the log. Log each insertion, too: every log is a line of runs.csv (log, "
            "infill_density_percent, infill_direction_deg, offset_mm, outcome; outcome: probe, inserted or the class), "
            "which optimize identify reads." }
    }
}

fn outcome_figure(Picture { outcome, svg, task }: &Picture) -> Markup {
    let class = usize::from(outcome.failure().unwrap_or(0));
    html! {
        figure {
            img src=(data_url(svg)) alt=(outcome.label());
            figcaption {
                b { (if class == 0 { "+".to_owned() } else { class.to_string() }) " " (outcome.label()) } ": "
                (MEANINGS[class]) " (simulated, " (task) ")"
            }
        }
    }
}

fn boxes(task: &Task, name: &str, (density, direction): (f64, f64)) -> Markup {
    html! {
        h1 { (task.name) ": infill density " (density) " %, direction " (direction) "°" }
        p.line { "Date" i {} "Finger no." i {} "Log of the probe" i {} "Start taught at" i {} "Start 0, 3 of 3" i {} }
        @for (title, sign) in [("-", -1), ("+", 1)] {
            h2 { "Outward to " (title) ", mm" }
            table {
                @for row in 0..2 {
                    tr { @for step in 1..=BOXES { th { (format!("{:+.1}", 0.5 * f64::from(sign * (row * BOXES + step)))) } } }
                    tr.empty { @for _ in 1..=BOXES { td {} } }
                }
            }
            h2 { "Near the end at " (title) ": start, mm, and how it ended" }
            table {
                @for word in ["mm", "+ 1234", "mm", "+ 1234"] { tr.empty { th { (word) } @for _ in 0..BOXES { td {} } } }
            }
            p.line { "End, mm" i {} "Class beyond it" i {} "Gaps, mm" i {} }
        }
        p.line { "Largest force N" i {} "Attempts" i {} "Notes" i {} }
        pre {
            "optimize measure add bench.csv --task " (name) " --density " (density) " --direction " (direction) " \\\n"
            "         --negative-mm ______ --positive-mm ______ --failure-negative __ --failure-positive __ \\\n"
            "         --peak-force-n ______ --date ____-__-__"
        }
    }
}
