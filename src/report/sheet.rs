//! The sheet to measure windows by hand: how, and boxes to fill in, on A4.

use super::elements::{inert, styled};
use input::units::{DEG, MM};
use insertion::outcome::{FailureClass, Outcome};
use insertion::task::Task;
use maud::{Markup, html};

/// Starts of the coarse walk that have boxes, on each side.
const WALK: i32 = 12;
/// Boxes for starts near each end.
const NEAR: usize = 12;

/// How an insertion may end, as simulated.
#[derive(Debug, Clone)]
pub struct Picture {
    /// How it ended.
    pub outcome: Outcome,
    /// Plug, fingertips and socket at the end, seen along x.
    pub svg: String,
    /// The shipped task that it is of, unless it is the sheet's own.
    pub example: Option<&'static str>,
}

/// What is to be measured.
#[derive(Debug, Clone, Copy)]
pub struct Sheet<'a> {
    /// The task.
    pub task: &'a Task,
    /// How commands name it.
    pub name: &'a str,
    /// Infill density, percent, and direction, degrees, of each finger.
    pub fingers: &'a [(f64, f64)],
    /// One of each outcome.
    pub pictures: &'a [Picture],
}

/// The sheet as a page: how to measure, then a page for each finger.
pub fn page(sheet: &Sheet<'_>) -> String {
    let body = html! {
        section { (how(sheet)) }
        @for &finger in sheet.fingers { section { (boxes(sheet, finger)) } }
    };
    styled(&format!("Measuring sheet: {}", sheet.task.name), include_str!("sheet.css"), body)
}

fn how(sheet: &Sheet<'_>) -> Markup {
    let Sheet { task, pictures, .. } = sheet;
    let [x, y, z] = task.strategy.start.map(|place| format!("{:.1}", place / MM));
    let (depth, tilt) = (task.success.depth / MM, task.success.tilt / DEG);
    html! {
        h1 { "Measuring sheet: " (task.name) }
        p { (task.description) }
        p.line { "Date" i {} "Robot" i {} "Measured by" i {} "Socket no." i {} "Force limit N" i {} }
        h2 { "Where to teach" }
        p { "Limit the robot's force before the first insertion. By the task file the search begins with the TCP at x " (x)
            ", y " (y) ", z " (z) " mm from the middle of the socket's opening (z out of it), the plug tilted by "
            (format!("{:.1}", task.strategy.tilt / DEG)) "°. Teach the start near there from which the plug inserts "
            "three times of three: this is 0. Shifts are along y, in which the jaws close; + is away from the wall that "
            "the search moves to. Keep grasp, speeds, plug and socket the same for all fingers." }
        h2 { "Which starts, in which order" }
        ol {
            li { "From 0 in steps of 0.5 mm to -, until two neighbouring starts fail; then the same to +." }
            li { "A start that fails while the next one inserts: try it again. If it fails again, it is a gap: note it, and go on." }
            li { "Near each end, by 0.1 mm: first the middle between the last start that inserted and the first that failed, "
                 "then where you are least sure, until about half of the attempts insert at one start or between two "
                 "neighbours; at least 8 attempts. That start is the end." }
        }
        h2 { "What counts as inserted" }
        p { "At rest after the push the tip is at least " (format!("{depth:.1}")) " mm below the socket's top, the plug leans by "
            "at most " (format!("{tilt:.1}")) "°, and both fingers still hold it. Write + for inserted, else the class:" }
        div.pictures { @for picture in *pictures { (drawn(picture)) } }
    }
}

fn drawn(Picture { outcome, svg, example }: &Picture) -> Markup {
    let class = outcome.failure().map_or("+".to_owned(), |class| class.to_string());
    let words = match outcome {
        Outcome::Failed(FailureClass::ContactLossBeforeSearch) => {
            "the plug leaves the fingers before it is at the socket"
        }
        Outcome::Failed(FailureClass::PlugMissed) => {
            "the leading edge is not in the opening when the search ends"
        }
        Outcome::Failed(FailureClass::Jammed) => "it is in the opening, and is not seated",
        Outcome::Failed(FailureClass::ContactLossInInsertion) => {
            "the plug leaves the fingers, or slips in them, in search or push"
        }
        Outcome::Inserted | Outcome::Diverged => "seated, upright, held",
    };
    html! {
        figure {
            img src=(inert(svg)) alt=(outcome.label());
            figcaption {
                b { (class) " " (outcome.label()) } ": " (words)
                @if let Some(task) = example { " (simulated: " (task) ")" } @else { " (simulated)" }
            }
        }
    }
}

fn boxes(Sheet { task, name, .. }: &Sheet<'_>, (density, direction): (f64, f64)) -> Markup {
    let start = |step: i32| format!("{:+.1}", 0.5 * f64::from(step));
    html! {
        h1 { (task.name) ": infill density " (density) " %, direction " (direction) "°" }
        p.line { "Date" i {} "Finger no." i {} "Start taught at" i {} "Start 0, 3 of 3" i {} }
        @for (title, sign) in [("-", -1), ("+", 1)] {
            h2 { "Outward to " (title) ", mm" }
            table { tr { @for step in 1..=WALK { th { (start(sign * step)) } } } tr.empty { @for _ in 1..=WALK { td {} } }
                    tr.empty { @for _ in 1..=WALK { td {} } } }
            h2 { "Near the end at " (title) ": start, mm, and how it ended" }
            table { tr.empty { th { "mm" } @for _ in 0..NEAR { td {} } } tr.empty { th { "+ 1 2 3 4" } @for _ in 0..NEAR { td {} } }
                    tr.empty { th { "mm" } @for _ in 0..NEAR { td {} } } tr.empty { th { "+ 1 2 3 4" } @for _ in 0..NEAR { td {} } } }
            p.line { "End, mm" i {} "Class beyond it" i {} "Gaps, mm" i {} }
        }
        p.line { "Largest force N" i {} "Attempts" i {} "Notes" i {} }
        p { "Then:" }
        pre {
            "optimize measure add bench.csv --task " (name) " --density " (density) " --direction " (direction) " \\\n"
            "         --negative-mm ______ --positive-mm ______ --failure-negative __ --failure-positive __ \\\n"
            "         --peak-force-n ______ --date ____-__-__"
        }
    }
}
