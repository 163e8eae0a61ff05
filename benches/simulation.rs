//! Time of what is simulated: `cargo bench --bench simulation`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use divan::{Bencher, black_box};
use finray::geometry::Geometry;
use finray::infill::InfillDesign;
use finray::mechanics;
use finray::printed::PrintedFinger;
use input::shipped::{FINGERS, ROBOTS, Shipped, TASKS};
use input::units::N_PER_MM;
use insertion::evaluation::tolerance::{self, Search};
use insertion::finger::Finger;
use insertion::robot::Robot;
use insertion::task::Task;
use insertion::trial::engine::EngineKind;
use insertion::trial::{Grasp, Rig};

fn main() {
    divan::main();
}

const TASK_NAMES: [&str; 4] = ["usb", "ket8", "ket12", "rj45"];

fn shipped<'a>(files: &'a [Shipped], name: &str) -> &'a Shipped {
    files.iter().find(|file| file.name == name).expect("it is shipped")
}

fn task(name: &str) -> Task {
    let file = shipped(TASKS, name);
    Task::parse(file.text, file.file).expect("a task")
}

/// The finger of measured design 5 on a task, with the robot `servo`.
fn rig(task: &Task, engine: EngineKind) -> (Box<dyn Rig>, Finger) {
    let robot = shipped(ROBOTS, "servo");
    let robot = Robot::parse(robot.text, robot.file).expect("a robot");
    let finger = Finger::new(2.6 * N_PER_MM, 45.0 * N_PER_MM).with_model(&task.finger, 0.0);
    (engine.rig(task, &robot, &finger, 1.0).expect("the engine has it all"), finger)
}

fn trial(bencher: Bencher, task: &Task, engine: EngineKind) {
    let (rig, finger) = rig(task, engine);
    bencher.bench(|| rig.grasp(Grasp::of(black_box(&finger))).trial(0.0));
}

#[divan::bench(args = TASK_NAMES, sample_count = 10, sample_size = 1)]
fn trial_direct(bencher: Bencher, name: &str) {
    trial(bencher, &task(name), EngineKind::Direct);
}

#[divan::bench(args = TASK_NAMES, sample_count = 3, sample_size = 1)]
fn trial_rapier(bencher: Bencher, name: &str) {
    trial(bencher, &task(name), EngineKind::Rapier);
}

#[divan::bench(args = TASK_NAMES, sample_count = 5, sample_size = 1)]
fn evaluation(bencher: Bencher, name: &str) {
    let (rig, finger) = rig(&task(name), EngineKind::Direct);
    bencher.bench(|| tolerance::evaluate(&*rig, black_box(&finger), Search::default()));
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn stiffness_of_a_printed_finger(bencher: Bencher) {
    let finger = PrintedFinger::parse(FINGERS[0].text, FINGERS[0].file).expect("a finger");
    let design = InfillDesign { density_percent: 20.0, direction_deg: 10.0, phase_mm: None };
    bencher.bench(|| {
        let geometry = Geometry::new(black_box(&finger), &design).expect("it fits");
        mechanics::compute(&geometry).expect("a stiffness")
    });
}
