//! Levers, capture maps and another robot of the finger that a study names, kept in its folder beside
//! the journal.

use super::open::Ended;
use super::report;
use crate::commands::levers::levers;
use crate::commands::map::map_of;
use crate::context::not_stopped;
use crate::failure::Failure;
use crate::setup::Setup;
use crate::setup::files::robot;
use crate::setup::robots::felt;
use ::report::answer::command::own_task;
use ::report::answer::{Answer, UnderRobot};
use analysis::levers::Levers;
use analysis::map::{Axes, CaptureMap};
use input::files::{self, LARGEST_OWN};
use insertion::evaluation::Evaluation;
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::tolerance::Search;
use insertion::robot::Robot;
use insertion::space::Design;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use study::{Provenance, StudyRecord, write_own_file};

const LEVERS: &str = "levers.json";
const MAPS: &str = "maps.json";
const ROBOTS: &str = "robots.json";
/// Errors that are mapped beside that along y.
const MAPPED: [Axes; 2] = [Axes::YX, Axes::YYaw];

/// What is known of the named finger beside its window.
#[derive(Debug, Clone, Default)]
pub struct Around {
    /// What would help it more than its infill.
    pub levers: Option<Levers>,
    /// How insertions end over two errors of the start.
    pub maps: Vec<CaptureMap>,
    /// Its window under the robot of the study and under one as different, if the task is one's own.
    pub robots: Vec<UnderRobot>,
}

/// A file, and what it is of.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept<T> {
    provenance: Provenance,
    design: Design,
    found: T,
}

impl Around {
    /// What the folder of a study holds of the finger that it names.
    pub(crate) fn read(dir: &Path, record: &StudyRecord) -> Self {
        let Some((provenance, design)) = subject(record) else { return Around::default() };
        let levers: Option<Levers> = read(&dir.join(LEVERS), (&provenance, &design));
        Around {
            // The span of the infill is that of all evaluations until now.
            levers: levers.map(|found| Levers {
                infill: record.spread_mm().unwrap_or(found.infill),
                ..found
            }),
            maps: read(&dir.join(MAPS), (&provenance, &design)).unwrap_or_default(),
            robots: read(&dir.join(ROBOTS), (&provenance, &design)).unwrap_or_default(),
        }
    }
}

impl Ended {
    /// Measures what is not known yet of levers, maps and robots of the named finger, keeps and shows it
    /// on the page; nothing of several tasks, and where no finger is named.
    ///
    /// # Errors
    /// If the finger cannot be simulated or a file not be written; if `stop` is set meanwhile.
    pub fn around(&self, stop: &AtomicBool) -> Result<Around, Failure> {
        let (dir, record) = (&self.dir, &self.record);
        let mut found = Around::read(dir, record);
        let (levers_wanted, maps_wanted) = (
            found.levers.is_none() && !self.how.no_levers,
            found.maps.is_empty() && !self.how.no_map,
        );
        let Some((provenance, design)) = subject(record) else { return Ok(found) };
        let robots_wanted = found.robots.is_empty() && own_task(record);
        if !levers_wanted && !maps_wanted && !robots_wanted {
            return Ok(found);
        }
        let engine = &provenance.engine.name;
        let mut setup = Setup::from_inputs(&record.inputs(dir)?, engine)?;
        self.how.pool()?.install(|| {
            if levers_wanted {
                let known =
                    levers(&setup, setup.only_task()?, (&design, None), record.spread_mm(), stop)?;
                write(&dir.join(LEVERS), (&provenance, &design), &known)?;
                found.levers = Some(known);
            }
            if maps_wanted {
                found.maps = maps(&setup, &design, stop)?;
                write(&dir.join(MAPS), (&provenance, &design), &found.maps)?;
            }
            if robots_wanted {
                found.robots = robots(&mut setup, record, &design, stop)?;
                write(&dir.join(ROBOTS), (&provenance, &design), &found.robots)?;
            }
            Ok::<_, Failure>(())
        })?;
        report::write(dir, record, &setup.evaluator.surrogate)?;
        Ok(found)
    }
}

/// The finger that a study of one task names, and what it was measured by.
fn subject(record: &StudyRecord) -> Option<(Provenance, Design)> {
    let design = Answer::of(record).verdict.finger()?.clone();
    let one = !record.config.several_tasks() && record.config.objective.single().is_some();
    let provenance = record.segments.last()?.provenance.clone();
    one.then_some((provenance, design))
}

fn maps(setup: &Setup, design: &Design, stop: &AtomicBool) -> Result<Vec<CaptureMap>, Failure> {
    let (template, evaluator) = (setup.only_task()?, &setup.evaluator);
    let stiffness = evaluator.predict(design).map_err(Failure::input)?;
    let specimen = evaluator.specimen(template, design, stiffness).map_err(Failure::input)?;
    let taught = evaluator.taught(&specimen, stop).map_err(Failure::input)?;
    let map = |axes| map_of(setup, (&specimen, design), taught, axes, stop);
    MAPPED.into_iter().map(map).collect()
}

/// Stiffness along y below which a robot counts as compliant: above `servo`, below `ur5e_position`.
const COMPLIANT_N_PER_MM: f64 = 20.0;

/// The window that the study names, and that under a robot as different as can be: of a compliant one
/// the position-controlled arm, of others the compliant flange, which the setup is left with.
fn robots(
    setup: &mut Setup,
    record: &StudyRecord,
    design: &Design,
    stop: &AtomicBool,
) -> Result<Vec<UnderRobot>, Failure> {
    let (template, evaluator) = (setup.only_task()?, &setup.evaluator);
    let stiffness = evaluator.predict(design).map_err(Failure::input)?;
    let specimen = evaluator.specimen(template, design, stiffness).map_err(Failure::input)?;
    let start = [specimen.task.turn, specimen.task.strategy.tilt];
    let under = |robot: &Robot, measured: Evaluation| {
        let (stiffness_n_per_mm, _) = felt(robot, start)?;
        Ok::<_, Failure>(UnderRobot { robot: robot.name.clone(), stiffness_n_per_mm, measured })
    };
    let known = Answer::of(record).shown().and_then(|(_, tasks)| tasks.first().copied().cloned());
    let Some(known) = known else { return Ok(Vec::new()) };
    let own = under(&evaluator.robot, known)?;
    let compliant = own.stiffness_n_per_mm.is_some_and(|[_, y, _]| y < COMPLIANT_N_PER_MM);
    setup.evaluator.robot = robot(if compliant { "ur5e_position" } else { "servo" })?;
    let (evaluator, plan) = (&setup.evaluator, &Plan::WINDOW);
    let found = evaluator.measure_or_teach(&specimen, Search::Walk, plan, stop);
    let found = found.map_err(Failure::input)?;
    not_stopped(stop)?;
    Ok(vec![own, under(&evaluator.robot, found)?])
}

/// What a file holds; `None` where it is missing, damaged or of something else.
fn read<T: DeserializeOwned>(
    path: &Path,
    (provenance, design): (&Provenance, &Design),
) -> Option<T> {
    let text = files::read_own(path, LARGEST_OWN).ok()?;
    let kept: Kept<T> = serde_json::from_str(&text).ok()?;
    (kept.provenance == *provenance && kept.design == *design).then_some(kept.found)
}

fn write<T: Serialize>(
    path: &Path,
    (provenance, design): (&Provenance, &Design),
    found: &T,
) -> Result<(), Failure> {
    let kept = Kept { provenance: provenance.clone(), design: design.clone(), found };
    let text = serde_json::to_string(&kept)
        .map_err(|error| Failure::running(format!("{}: {error}", path.display())))?;
    Ok(write_own_file(path, &(text + "\n"))?)
}
