//! Check of a task's geometry and commanded moves, without simulation.

mod grasp;
mod parts;
mod socket;
mod strategy;
mod units;

pub use units::FACES_MM;

use super::body::{clipped, extent, width};
use super::seat::TaskBodies;
use input::InputError;
use input::units::MM;
use insertion::task::Success;
use insertion::{Part, Solid, Task};
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

    /// Returns the faults of an invalid file.
    pub fn of_file(error: &InputError) -> Vec<Self> {
        let problem = &*error.problem;
        let Some(key) = &error.place.key else {
            let fault = |text: &str| {
                // The parser names an unknown or missing key in backticks.
                let key = text.split_once(" field `").and_then(|(_, rest)| rest.split('`').next());
                let remedy = "see docs/guide/tasks.md, or `optimize task show usb`";
                Problem::new(key.unwrap_or("the file"), text, remedy)
            };
            // All faults begin with the same words.
            let faults = problem.replace("\nTOML parse error", "\0TOML parse error");
            return faults.split('\0').map(fault).collect();
        };
        // The text of an error states the fault and then, after a semicolon, what is accepted.
        let whole = (problem, "see docs/guide/tasks.md");
        let (problem, remedy) = problem.split_once("; ").unwrap_or(whole);
        vec![Problem::new(key, problem, remedy)]
    }
}

/// Returns the numbers of a task that are probably in a wrong unit.
pub fn wrong_units(task: &Task) -> Vec<Problem> {
    units::problems(&TaskBodies::new(task))
}

/// Returns the faults of a task, causes before consequences.
pub fn problems(task: &Task) -> Vec<Problem> {
    let reached;
    let mut case = TaskBodies::new(task);
    // With a wrong unit, all other checks would fail too.
    let mut found = units::problems(&case);
    if !found.is_empty() {
        return found;
    }
    // Shapes with a mated pose were compared with their drawings when they were imported.
    if task.success.mated.is_none() {
        found.extend(parts::problems(&case));
        found.extend(socket::walls(&case));
        let seat = case.deepest();
        found.extend(socket::depth(&case, &seat));
        // The checks below would name the consequences of a success depth that is too large.
        if found.iter().any(|problem| problem.key == socket::DEPTH_KEY) {
            let success = Success { depth: seat.depth, ..task.success };
            reached = Task { success, ..task.clone() };
            case = TaskBodies::new(&reached);
        }
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

/// Returns an interval as in a task file, mm.
fn interval([from, to]: [f64; 2]) -> String {
    format!("[{}, {}]", mm(from), mm(to))
}

/// Returns an interval in words, mm.
fn range(ends: [f64; 2]) -> String {
    let [from, to] = ends.map(mm);
    format!("from {from} to {to} mm")
}

/// Returns the key of the extent along an axis (0 x, 1 y) of the plug part that is widest below the socket's top.
fn widest_key(case: &TaskBodies, depth: f64, axis: usize) -> Option<String> {
    let below = |part: &Part| {
        width(extent(clipped(&part.solid.corners(), 2, [f64::NEG_INFINITY, depth]), axis))
    };
    let part = case.plug.parts.iter().max_by(|a, b| below(a).total_cmp(&below(b)))?;
    Some(part_key("plug", &part.name, field(&part.solid, axis)))
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
