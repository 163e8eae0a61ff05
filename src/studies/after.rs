//! Analyses of the recommended finger after the answer of a study.

use super::around::{Around, LEVERS, MAPS, ROBOTS, subject, write};
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
use analysis::map::{Axes, CaptureMap};
use insertion::evaluation::Evaluation;
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::tolerance::Search;
use insertion::robot::Robot;
use insertion::space::Design;
use std::sync::atomic::AtomicBool;
use study::StudyRecord;

/// Errors that are mapped beside that along y.
const MAPPED: [Axes; 2] = [Axes::YX, Axes::YYaw];

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
