//! Largest contact forces that the connectors of a study and its robot withstand.

use super::Inputs;
use insertion::{Robot, Task};

/// Largest contact forces of a study, N.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ForceLimits {
    /// Limit of each connector, for those whose task file has one.
    pub connectors: Vec<Option<f64>>,
    /// Robot, which stops at its stop force; `None` if its file cannot be read.
    pub robot: Option<Robot>,
    /// Largest force of the contact springs of each connector, for those whose task file gives it.
    pub mating: Vec<Option<f64>>,
}

impl ForceLimits {
    /// Reads the limits from the input files of a study; a file that cannot be read gives none.
    pub(super) fn of(inputs: &Inputs, tasks: usize) -> Self {
        let task = |number: usize| Task::parse(inputs.get(&format!("task_{number}"))?, "").ok();
        let tasks: Vec<Option<Task>> = (1..=tasks).map(task).collect();
        let of = |force: fn(&Task) -> Option<f64>| -> Vec<Option<f64>> {
            tasks.iter().map(|task| task.as_ref().and_then(force)).collect()
        };
        ForceLimits {
            connectors: of(|task| task.limits.force),
            mating: of(Task::largest_mating_force),
            robot: inputs.get("robot").and_then(|text| Robot::parse(text, "").ok()),
        }
    }

    /// Returns the largest acceptable force on a task, by its index; infinite if there is none.
    pub fn acceptable(&self, task: usize) -> f64 {
        let connector = self.connectors.get(task).copied().flatten();
        let of_robot = self.robot.as_ref().map(|robot| robot.acceptable_force(connector));
        of_robot.or(connector).unwrap_or(f64::INFINITY)
    }
}
