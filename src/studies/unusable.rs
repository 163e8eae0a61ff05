//! Diagnosis of a study in which no design inserts at the nominal start.

use crate::{Failure, Setup, not_stopped};
use insertion::outcome::{STOP_REMEDY, stop_words};
use insertion::trial::{Trial, picture};
use insertion::{Evaluation, Grasp, Outcome, Robot, Scenario, StartRule, Template};
use report::answer::words::{outcome, remedy};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use study::{Recorded, StudyRecord, write_own_file};

pub(crate) const PICTURE: &str = "nominal.svg";

/// Checks that at least one design inserts at the nominal start of each task.
///
/// # Errors
/// If none does, with the outcome of the design nearest to an insertion; if `stop` is set meanwhile.
pub(crate) fn check(
    dir: &Path,
    record: &StudyRecord,
    setup: &Setup,
    stop: &AtomicBool,
) -> Result<(), Failure> {
    let Some((task, nearest)) = record.unusable() else { return Ok(()) };
    let Some(template) = setup.evaluator.templates.get(task) else { return Ok(()) };
    let (scenario, trial) = nominal(nearest, (task, template), setup, |_| (), stop)?;
    let class = outcome(trial.outcome) + stop_words(trial.robot_stopped);
    let phase =
        trial.phases.last().map_or(String::new(), |phase| format!(" in phase {}", phase.name));
    let label = format!("evaluation {} at the nominal start: {class}{phase}", nearest.index);
    let file = dir.join(PICTURE);
    write_own_file(&file, &picture::svg(&scenario.task, &scenario.finger.pad, &trial, &label))?;
    let by_robot = record.robot_stop == Some(nearest.index);
    let teach = match scenario.task.strategy.rule {
        StartRule::Given if !by_robot => ". `--start taught` moves it to where the finger inserts",
        _ => "",
    };
    let remedy = remedy(trial.outcome, trial.robot_stopped);
    let remedy = if by_robot { STOP_REMEDY } else { &remedy };
    let file = file.display();
    Err(Failure::running(format!(
        "no design of the study inserts at the nominal start of {}: evaluation {} ends with {class}{phase}, \
         at depth {:.2} mm and tilt {:.2} deg; {file} shows it. {remedy}{teach}",
        scenario.task.name, nearest.index, trial.depth_mm, trial.tilt_deg
    )))
}

/// Returns the index of the evaluation that is nearest to an insertion, if no design inserts, but this one would
/// without robot stop.
///
/// # Errors
/// If it cannot be simulated; if `stop` is set meanwhile.
pub(crate) fn robot_stop(
    record: &StudyRecord,
    setup: &Setup,
    stop: &AtomicBool,
) -> Result<Option<u64>, Failure> {
    let Some((task, nearest)) = record.unusable() else { return Ok(None) };
    let stopped = nearest.on(task).is_some_and(Evaluation::nominal_stop);
    let template = setup.evaluator.templates.get(task).filter(|_| stopped);
    let Some(template) = template else { return Ok(None) };
    let free = |robot: &mut Robot| robot.stop_force = f64::INFINITY;
    let (_, trial) = nominal(nearest, (task, template), setup, free, stop)?;
    Ok((trial.outcome == Outcome::Inserted).then_some(nearest.index))
}

/// Returns the trial of a design at the nominal start of the task at a place, after a change of the robot.
fn nominal(
    design: &Recorded,
    (place, template): (usize, &Template),
    Setup { evaluator, .. }: &Setup,
    change: impl Fn(&mut Robot),
    stop: &AtomicBool,
) -> Result<(Scenario, Trial), Failure> {
    let mut scenario = evaluator.scenario(template, &design.design, design.stiffness)?;
    change(&mut scenario.robot);
    let taught = design.on(place).and_then(|found| found.taught);
    let rig = evaluator.rig(&scenario, taught, 1.0)?;
    let trial = rig.grasp(Grasp { stop, ..Grasp::of(&scenario.finger) }).trial(0.0);
    not_stopped(stop)?;
    drop(rig);
    Ok((scenario, trial))
}
