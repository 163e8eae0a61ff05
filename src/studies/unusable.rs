//! Diagnosis of a study in which no design inserts at the nominal start.

use crate::{Failure, Setup, not_stopped};
use insertion::outcome::stop_words;
use insertion::trial::{Trial, picture};
use insertion::{Grasp, Outcome, Scenario, StartRule};
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
    let Some((nearest, scenario, trial)) = nominal(record, setup, true, stop)? else {
        return Ok(());
    };
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
    let remedy = remedy(trial.outcome, trial.robot_stopped, by_robot);
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
    let found = nominal(record, setup, false, stop)?;
    let found = found.filter(|(.., trial)| trial.outcome == Outcome::Inserted);
    Ok(found.map(|(nearest, ..)| nearest.index))
}

/// Returns the design that is nearest to an insertion, if none inserts, with the trial at its nominal start, of a robot
/// that `stops` at its limits or does not.
fn nominal<'a>(
    record: &'a StudyRecord,
    Setup { evaluator, .. }: &Setup,
    stops: bool,
    stop: &AtomicBool,
) -> Result<Option<(&'a Recorded, Scenario, Trial)>, Failure> {
    let Some((task, nearest)) = record.unusable() else { return Ok(None) };
    let Some(template) = evaluator.templates.get(task) else { return Ok(None) };
    let mut scenario = evaluator.scenario(template, &nearest.design, nearest.stiffness)?;
    if !stops {
        scenario.robot = scenario.robot.without_stops();
    }
    let taught = nearest.on(task).and_then(|found| found.taught);
    let rig = evaluator.rig(&scenario, taught, 1.0)?;
    let trial = rig.grasp(Grasp { stop, ..Grasp::of(&scenario.finger) }).trial(0.0);
    not_stopped(stop)?;
    drop(rig);
    Ok(Some((nearest, scenario, trial)))
}
