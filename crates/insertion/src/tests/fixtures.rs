//! Shipped inputs, fingers and predictions for tests.

use crate::evaluation::uncertainty::Uncertainty;
use crate::trial::run::EngineRig;
use crate::{Estimate, Finger, FingerFile, Prediction, Robot, Task, Template};
use contact::direct::Direct;
use input::shipped::{FINGERS, ROBOTS, Shipped, TASKS, UNCERTAINTIES};
use input::units::N_PER_MM;

/// Returns the text of a shipped task and its path.
pub fn task_file(name: &str) -> &'static Shipped {
    TASKS.iter().find(|file| file.name == name).unwrap()
}

/// Returns the text of a shipped robot and its path.
pub fn robot_file(name: &str) -> &'static Shipped {
    ROBOTS.iter().find(|file| file.name == name).unwrap()
}

pub fn task(name: &str) -> Task {
    let file = task_file(name);
    Task::parse(file.text, file.file).unwrap()
}

pub fn robot(name: &str) -> Robot {
    let file = robot_file(name);
    Robot::parse(file.text, file.file).unwrap()
}

pub fn finger_file() -> FingerFile {
    FingerFile::parse(FINGERS[0].text, FINGERS[0].file).unwrap()
}

/// Returns a shipped task whose numbers can be set.
pub fn template(name: &str) -> Template {
    let file = task_file(name);
    Template::parse(file.text, file.file).unwrap()
}

/// Returns the shipped uncertainty.
pub fn typical() -> Uncertainty {
    Uncertainty::parse(UNCERTAINTIES[0].text, "typical").unwrap()
}

/// Asserts that the result is an error whose message contains all these parts.
pub fn refused<T>(result: Result<T, impl ToString>, parts: &[&str]) {
    let error = result.err().unwrap_or_else(|| panic!("accepted: {parts:?}")).to_string();
    for part in parts {
        assert!(error.contains(part), "`{part}` is not in: {error}");
    }
}

/// Returns a finger with this stiffness in the compliance and assembly directions, N/mm.
pub fn finger(compliance: f64, assembly: f64) -> Finger {
    Finger::new(compliance * N_PER_MM, assembly * N_PER_MM)
}

/// Returns a task on the robot `servo` in the engine `direct`.
pub fn rig(task: Task) -> EngineRig {
    EngineRig::new(task, &robot("servo"), Box::<Direct>::default()).unwrap()
}

/// Returns a prediction with mean and standard deviation of the compliance and of the assembly stiffness, N/mm.
pub fn predicted(compliance: [f64; 2], assembly: [f64; 2]) -> Prediction {
    let [compliance, assembly] = [compliance, assembly]
        .map(|[mean, sd]| Estimate { mean: mean * N_PER_MM, sd: sd * N_PER_MM });
    Prediction { compliance, assembly, hull_distance: 0.0 }
}
