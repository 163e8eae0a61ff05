//! `lab benchmark`: speed of the simulation on this machine.

use super::{Failure, print, print_json};
use clap::Args;
use finger_opt::session::{self, DEFAULT_ROBOT};
use input::shipped::TASKS;
use input::units::N_PER_MM;
use insertion::evaluation::tolerance::{self, Search};
use insertion::finger::Finger;
use insertion::robot::Robot;
use insertion::task::Task;
use insertion::trial::engine::EngineKind;
use rayon::prelude::*;
use serde::Serialize;
use serde_json::json;
use std::time::Instant;

/// Evaluations of the study whose time is estimated.
const BUDGET: f64 = 200.0;
/// Compliance and assembly stiffness of the finger, N/mm: those of measured design 5.
const COMPLIANCE: f64 = 2.6;
const ASSEMBLY: f64 = 45.0;

/// Measure how fast this machine simulates.
///
/// One finger is evaluated on every task, on as many threads as a study would
/// use; the time of a study is estimated from it. Close other programs first.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Robot: see `optimize tasks`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    robot: String,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    engine: EngineKind,
    /// Evaluations per task, at the same time
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: u32,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct TaskSpeed {
    task: String,
    trials_per_s: f64,
    evaluations_per_min: f64,
    /// Time of a study of [`BUDGET`] evaluations, s.
    study_s: f64,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let robot = session::robot(&arguments.robot)?;
    let rows = TASKS
        .iter()
        .map(|file| {
            let task = Task::parse(file.text, file.file).map_err(Failure::input)?;
            measure(&task, &robot, arguments)
        })
        .collect::<Result<Vec<TaskSpeed>, Failure>>()?;
    if !arguments.json {
        return print(&table(&rows));
    }
    print_json(&json!({
        "robot": arguments.robot,
        "engine": arguments.engine.name(),
        "threads": rayon::current_num_threads(),
        "budget": BUDGET,
        "tasks": rows,
    }))
}

fn measure(task: &Task, robot: &Robot, arguments: &Arguments) -> Result<TaskSpeed, Failure> {
    let finger = Finger::new(COMPLIANCE * N_PER_MM, ASSEMBLY * N_PER_MM);
    let finger = finger.shaped(&task.finger, 0.0);
    let rig = arguments.engine.rig(task, robot, &finger, 1.0).map_err(Failure::input)?;
    let clock = Instant::now();
    let trials = |_| tolerance::evaluate(&*rig, &finger, Search::default()).trials;
    let trials: u32 = (0..arguments.repeats).into_par_iter().map(trials).sum();
    let wall_s = clock.elapsed().as_secs_f64().max(f64::MIN_POSITIVE);
    let evaluations_per_min = 60.0 * f64::from(arguments.repeats) / wall_s;
    Ok(TaskSpeed {
        task: task.name.clone(),
        trials_per_s: f64::from(trials) / wall_s,
        evaluations_per_min,
        study_s: 60.0 * BUDGET / evaluations_per_min,
    })
}

fn table(rows: &[TaskSpeed]) -> String {
    let mut text = format!(
        "{} threads, finger of {COMPLIANCE} and {ASSEMBLY} N/mm\n\
         task     trials/s  evaluations/min  budget of {BUDGET} takes about\n",
        rayon::current_num_threads()
    );
    for TaskSpeed { task, trials_per_s, evaluations_per_min, study_s } in rows {
        text += &format!(
            "{task:<8} {trials_per_s:>8.1}  {evaluations_per_min:>15.1}  {study_s:>14.0} s\n"
        );
    }
    text
}
