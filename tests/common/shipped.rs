//! Shipped tasks and robots, and fingers by their stiffness, in the engine `direct`.

use contact::direct::Direct;
use finger_opt::setup::files;
use input::shipped::TASKS;
use input::units::N_PER_MM;
use insertion::finger::Finger;
use insertion::robot::Robot;
use insertion::task::Task;
use insertion::trial::run::EngineRig;

pub fn task(name: &str) -> Task {
    let file = TASKS.iter().find(|file| file.name == name).unwrap();
    Task::parse(file.text, file.file).unwrap()
}

pub fn robot(name: &str) -> Robot {
    files::robot(name).unwrap()
}

/// A task on a robot in the engine `direct`.
pub fn rig(task: Task, robot_name: &str) -> EngineRig {
    EngineRig::new(task, &robot(robot_name), Box::<Direct>::default()).unwrap()
}

/// A finger of these stiffnesses, N/mm.
pub fn finger(compliance: f64, assembly: f64) -> Finger {
    Finger::new(compliance * N_PER_MM, assembly * N_PER_MM)
}
