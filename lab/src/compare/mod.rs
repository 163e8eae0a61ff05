//! Comparison of tolerance windows: of the same fingers with another search, step or engine.

pub mod engines;
pub mod pairs;

#[cfg(test)]
mod tests;

use finger_opt::{Failure, read_task};
use input::shipped::TASKS;
use insertion::evaluation::tolerance;
use insertion::task::finger::FingerModel;
use insertion::{Evaluation, Finger, Measurement, Outcome, Rig, Search, Task, Window};
use rayon::prelude::*;
use std::sync::Arc;

/// Method by which windows on a task are determined: engine with its step, and search.
pub struct Setting {
    pub name: String,
    pub rig: Arc<dyn Rig>,
    pub search: Search,
}

impl Setting {
    pub fn evaluate(&self, finger: &Finger) -> Evaluation {
        tolerance::evaluate(&*self.rig, finger, self.search)
    }
}

/// Task and the two settings in which its windows are simulated, the reference first.
pub struct TaskSettings {
    pub task: Task,
    pub settings: [Setting; 2],
}

/// Measured finger on a task.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    pub task: String,
    pub design: Measurement,
    /// Finger with the measured stiffness, not the surrogate's.
    pub finger: Finger,
}

impl Subject {
    pub fn new(task: &str, model: &FingerModel, design: Measurement) -> Self {
        let finger = Finger::new(design.compliance, design.assembly);
        let finger = finger.with_model(model, design.direction_deg);
        Subject { task: task.to_owned(), design, finger }
    }

    /// Returns the infill as in `10 %, 30 deg`.
    pub fn infill(&self) -> String {
        format!("{} %, {} deg", self.design.density_percent, self.design.direction_deg)
    }
}

/// Calls `simulate` in parallel for every design on every task. Returns the results ordered by task, then by design.
pub fn each<T: Send>(
    tasks: &[TaskSettings],
    designs: &[Measurement],
    simulate: impl Fn(&Subject, &[Setting; 2]) -> T + Sync,
) -> Vec<T> {
    let pairs: Vec<_> =
        tasks.iter().flat_map(|task| designs.iter().map(move |d| (task, d))).collect();
    let one = |(on, design): (&TaskSettings, &Measurement)| {
        simulate(&Subject::new(&on.task.name, &on.task.finger, *design), &on.settings)
    };
    pairs.into_par_iter().map(one).collect()
}

/// Reads the task with this name, or for `all` the tasks of the paper.
///
/// # Errors
/// If it cannot be read.
pub fn tasks(name: &str) -> Result<Vec<Task>, Failure> {
    let names = match name {
        "all" => TASKS.iter().map(|shipped| shipped.name).collect(),
        name => vec![name],
    };
    names.into_iter().map(|name| Ok(read_task(name)?.task)).collect()
}

/// Formats a window as in `-1.4 to +5.8`, mm; `none` if the nominal start does not insert.
fn window_words(window: &Window) -> String {
    match window.nominal {
        Outcome::Inserted => {
            format!("{:+.1} to {:+.1}", window.negative_mm(), window.positive_mm())
        }
        _ => "none".to_owned(),
    }
}
