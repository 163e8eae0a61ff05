//! Whether a task can work: geometry and commands, before anything is simulated.

mod grasp;
mod lengths;
mod parts;
mod socket;
mod strategy;

use super::body::ConvexBody;
use super::seat::{Seat, Seating};
use input::InputError;
use input::units::MM;
use insertion::task::Task;
use serde::Serialize;

/// Something in a task file that cannot work.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Problem {
    /// The key, as a path that can be read off the file.
    pub key: String,
    /// What is wrong.
    pub problem: String,
    /// What would be right.
    pub remedy: String,
}

impl Problem {
    fn new(key: impl Into<String>, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Problem { key: key.into(), problem: problem.into(), remedy: remedy.into() }
    }
}

impl From<&InputError> for Problem {
    fn from(error: &InputError) -> Self {
        match error {
            InputError::Value { key, problem, .. } => match problem.split_once("; ") {
                Some((problem, remedy)) => Problem::new(key, problem, remedy),
                None => Problem::new(key, problem, "see docs/guide/tasks.md"),
            },
            InputError::Syntax { message, .. } => {
                // The parser names an unknown or missing key in backticks.
                let key = message.split('`').nth(1).unwrap_or("the file");
                Problem::new(key, message, "see docs/guide/tasks.md, or `optimize task show usb`")
            }
        }
    }
}

/// What the checks look at.
struct Case<'a> {
    task: &'a Task,
    plug: ConvexBody<'a>,
    socket: ConvexBody<'a>,
}

/// All that is wrong with a task, the cause before what follows from it.
pub fn problems(task: &Task) -> Vec<Problem> {
    let case =
        Case { task, plug: ConvexBody::plug(&task.plug), socket: ConvexBody::new(&task.socket) };
    // In a wrong unit everything else is wrong, too.
    let mut found = lengths::problems(&case);
    if !found.is_empty() {
        return found;
    }
    found.extend(parts::problems(&case));
    found.extend(socket::walls(&case));
    found.extend(socket::depth(&case, &seat(&case)));
    found.extend(grasp::problems(&case));
    found.extend(strategy::problems(&case));
    found
}

fn seat(case: &Case) -> Seat {
    Seating::new(case.task, &case.plug, &case.socket).deepest()
}

/// A length for a message: mm, two decimals at most.
fn mm(length: f64) -> String {
    format!("{}", (length / MM * 100.0).round() / 100.0 + 0.0)
}

/// From, to for a message.
fn pair([from, to]: [f64; 2]) -> String {
    format!("[{}, {}]", mm(from), mm(to))
}

/// The key of a part's field.
fn part_key(body: &str, name: &str, field: &str) -> String {
    format!("{body}.part \"{name}\" {field}")
}

/// The field of a part that has its extent along an axis.
fn field(solid: &insertion::task::Solid, axis: usize) -> &'static str {
    use insertion::task::Solid;
    match solid {
        Solid::Box { .. } => ["x_mm", "y_mm", "z_mm"][axis],
        Solid::Cylinder { .. } => ["diameter_mm", "diameter_mm", "z_mm"][axis],
        Solid::Prism { axis: along, .. } if *along == axis => "span_mm",
        Solid::Prism { .. } => "outline_mm",
        Solid::Hull { .. } => "points_mm",
    }
}
