//! Check of a task's geometry and commanded moves, without simulation.

mod grasp;
mod parts;
mod socket;
mod strategy;

pub use parts::FACES_MM;

use super::seat::TaskBodies;
use input::InputError;
use input::units::MM;
use insertion::task::{Solid, Task};
use serde::Serialize;

/// Fault of a task file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Problem {
    /// Key, as a path in the file.
    pub key: String,
    /// Description of the fault.
    pub problem: String,
    /// Advice on a value that works.
    pub remedy: String,
}

impl Problem {
    fn new(key: impl Into<String>, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Problem { key: key.into(), problem: problem.into(), remedy: remedy.into() }
    }
}

impl From<&InputError> for Problem {
    fn from(error: &InputError) -> Self {
        let problem = &*error.problem;
        let Some(key) = &error.place.key else {
            // The parser names an unknown or missing key in backticks.
            let key = problem.split('`').nth(1).unwrap_or("the file");
            let remedy = "see docs/guide/tasks.md, or `optimize task show usb`";
            return Problem::new(key, problem, remedy);
        };
        // The text of an error states the fault and then, after a semicolon, what is accepted.
        let whole = (problem, "see docs/guide/tasks.md");
        let (problem, remedy) = problem.split_once("; ").unwrap_or(whole);
        Problem::new(key, problem, remedy)
    }
}

/// Returns the faults of a task, causes before consequences.
pub fn problems(task: &Task) -> Vec<Problem> {
    let case = TaskBodies::new(task);
    // With a wrong unit, all other checks would fail too.
    let mut found = parts::lengths(&case);
    if !found.is_empty() {
        return found;
    }
    // Shapes with a mated pose were compared with their drawings when they were imported.
    if task.success.mated.is_none() {
        found.extend(parts::problems(&case));
        found.extend(socket::walls(&case));
        found.extend(socket::depth(&case, &case.deepest()));
    }
    found.extend(parts::mass(&case));
    found.extend(grasp::problems(&case));
    found.extend(strategy::problems(&case));
    found
}

/// Returns a length for a message: mm, two decimals at most.
fn mm(length: f64) -> String {
    format!("{}", (length / MM * 100.0).round() / 100.0 + 0.0)
}

/// Returns an interval for a message, mm.
fn interval([from, to]: [f64; 2]) -> String {
    format!("[{}, {}]", mm(from), mm(to))
}

/// Returns the key of a part, or of one of its fields.
fn part_key(body: &str, name: &str, field: &str) -> String {
    format!("{body}.part \"{name}\" {field}").trim_end().to_owned()
}

/// Returns the name of the field that contains the extent of a part along an axis.
fn field(solid: &Solid, axis: usize) -> &'static str {
    match solid {
        Solid::Box { .. } | Solid::Rounded(_) => ["x_mm", "y_mm", "z_mm"][axis],
        Solid::Cylinder { .. } => ["diameter_mm", "diameter_mm", "z_mm"][axis],
        Solid::Prism { axis: along, .. } if *along == axis => "span_mm",
        Solid::Prism { .. } => "outline_mm",
        Solid::Hull { .. } => "points_mm",
    }
}
