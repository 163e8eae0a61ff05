//! `lab benchmark`: speed of the simulation on this machine.

use super::{Failure, print};
use finger_opt::setup::files;
use finger_opt::setup::request::DEFAULT_ROBOT;
use input::shipped::TASKS;
use input::units::N_PER_MM;
use insertion::evaluation::tolerance::{self, Search};
use insertion::finger::Finger;
use insertion::task::Task;
use insertion::trial::engine::EngineKind;
use rayon::prelude::*;
use std::time::Instant;

/// Evaluations of the study whose time is estimated.
const BUDGET: f64 = 200.0;
/// Evaluations per task, at the same time.
const REPEATS: u32 = 4;
/// Compliance and assembly stiffness of the finger, N/mm: those of measured design 5.
const COMPLIANCE: f64 = 2.6;
const ASSEMBLY: f64 = 45.0;

pub fn run() -> Result<(), Failure> {
    let robot = files::robot(DEFAULT_ROBOT)?;
    let mut text = format!(
        "{} threads, finger of {COMPLIANCE} and {ASSEMBLY} N/mm\n\
         task     trials/s  evaluations/min  budget of {BUDGET} takes about\n",
        rayon::current_num_threads()
    );
    for file in TASKS {
        let task = Task::parse(file.text, file.file).map_err(Failure::input)?;
        let finger = Finger::new(COMPLIANCE * N_PER_MM, ASSEMBLY * N_PER_MM);
        let finger = finger.shaped(&task.finger, 0.0);
        let rig = EngineKind::default().rig(&task, &robot, &finger, 1.0).map_err(Failure::input)?;
        let clock = Instant::now();
        let trials = |_| tolerance::evaluate(&*rig, &finger, Search::default()).trials;
        let trials: u32 = (0..REPEATS).into_par_iter().map(trials).sum();
        let wall_s = clock.elapsed().as_secs_f64().max(f64::MIN_POSITIVE);
        let trials_per_s = f64::from(trials) / wall_s;
        let evaluations_per_min = 60.0 * f64::from(REPEATS) / wall_s;
        let study_s = 60.0 * BUDGET / evaluations_per_min;
        text += &format!(
            "{:<8} {trials_per_s:>8.1}  {evaluations_per_min:>15.1}  {study_s:>14.0} s\n",
            task.name
        );
    }
    print(&text)
}
