//! Diagnosis of a study in which no design inserts at the nominal start.

use crate::{Failure, Setup, not_stopped};
use insertion::outcome::stop_words;
use insertion::trial::picture;
use insertion::{Grasp, StartRule};
use report::answer::words::{outcome, remedy};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use study::{StudyRecord, write_own_file};

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
    let evaluator = &setup.evaluator;
    let scenario = evaluator.scenario(template, &nearest.design, nearest.stiffness)?;
    let taught = nearest.on(task).and_then(|found| found.taught);
    let rig = evaluator.rig(&scenario, taught, 1.0)?;
    let trial = rig.grasp(Grasp { stop, ..Grasp::of(&scenario.finger) }).trial(0.0);
    not_stopped(stop)?;
    let class = outcome(trial.outcome) + stop_words(trial.robot_stopped);
    let phase =
        trial.phases.last().map_or(String::new(), |phase| format!(" in phase {}", phase.name));
    let label = format!("evaluation {} at the nominal start: {class}{phase}", nearest.index);
    let file = dir.join(PICTURE);
    write_own_file(&file, &picture::svg(&scenario.task, &scenario.finger.pad, &trial, &label))?;
    let teach = match scenario.task.strategy.rule {
        StartRule::Given => ". `--start taught` moves it to where the finger inserts",
        StartRule::Taught => "",
    };
    let (file, remedy) = (file.display(), remedy(trial.outcome, trial.robot_stopped));
    Err(Failure::running(format!(
        "no design of the study inserts at the nominal start of {}: evaluation {} ends with {class}{phase}, \
         at depth {:.2} mm and tilt {:.2} deg; {file} shows it. {remedy}{teach}",
        scenario.task.name, nearest.index, trial.depth_mm, trial.tilt_deg
    )))
}
