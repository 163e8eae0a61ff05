//! Analyses of the recommended finger after a study: levers (one-at-a-time sensitivity of the range), capture maps, and
//! the window with a second robot. Each is stored in the study's folder and shown on its report page.

use super::open::Ended;
use super::report;
use crate::commands::levers::levers;
use crate::commands::map::map_of;
use crate::progress::cost;
use crate::setup::files::robot;
use crate::setup::robots::stiffness_and_lag;
use crate::{Context, Failure, Setup, not_stopped};
use ::report::PostAnalysis;
use ::report::answer::command::own_task;
use ::report::answer::{Answer, RobotWindow};
use analysis::levers::Levers;
use analysis::map::Axes;
use insertion::{Design, Evaluation, Robot, Scenario, Search};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use study::{Provenance, read_analysis, write_analysis};

const LEVERS: &str = "levers.json";
const MAPS: &str = "maps.json";
const ROBOTS: &str = "robots.json";
/// Axes of the maps: the error along y and a second error.
const MAPPED: [Axes; 2] = [Axes::YX, Axes::YYaw];
/// Stiffness along y below which a robot counts as compliant; it lies between those of `servo` and `ur5e_position`.
const COMPLIANT_N_PER_MM: f64 = 20.0;

/// Contents of a file: an analysis with the provenance and design for which it is valid.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored<T> {
    provenance: Provenance,
    design: Design,
    found: T,
}

/// Provenance and design for which the analyses are valid.
type Subject = Stored<()>;

impl Subject {
    /// Returns provenance and recommended design; `None` without one, or for several tasks or objectives.
    fn of(answer: &Answer) -> Option<Self> {
        let record = answer.record;
        let one = !record.config.several_tasks() && record.config.objective.single().is_some();
        let design = answer.verdict.finger().filter(|_| one)?.clone();
        Some(Stored { provenance: record.provenance().clone(), design, found: () })
    }

    /// Reads an analysis; `None` if it is missing or valid for another provenance or design.
    fn read<T: DeserializeOwned>(&self, dir: &Path, file: &str) -> Option<T> {
        let Stored { provenance, design, found } = read_analysis(dir, file)?;
        (provenance == self.provenance && design == self.design).then_some(found)
    }

    fn write<T: Serialize>(&self, dir: &Path, file: &str, found: &T) -> Result<(), Failure> {
        let (provenance, design) = (self.provenance.clone(), self.design.clone());
        Ok(write_analysis(dir, file, &Stored { provenance, design, found })?)
    }
}

/// Reads the analyses in a study's folder.
pub(crate) fn read(dir: &Path, answer: &Answer) -> PostAnalysis {
    let Some(subject) = Subject::of(answer) else { return PostAnalysis::default() };
    let levers: Option<Levers> = subject.read(dir, LEVERS);
    PostAnalysis {
        // The ranges over infills are those of all evaluations so far, of which there may be more since the analysis.
        levers: levers
            .map(|found| Levers { infill: answer.spread_mm.unwrap_or(found.infill), ..found }),
        maps: subject.read(dir, MAPS).unwrap_or_default(),
        robots: subject.read(dir, ROBOTS).unwrap_or_default(),
    }
}

impl Ended {
    /// Computes the missing analyses of the recommended finger, stores them and updates the page.
    ///
    /// # Errors
    /// If the finger cannot be simulated or a file cannot be written; if it is cancelled meanwhile.
    pub fn analyse(&self, answer: &Answer, context: &Context<'_>) -> Result<PostAnalysis, Failure> {
        let stop = context.stop;
        let (dir, record) = (&self.dir, answer.record);
        let mut found = read(dir, answer);
        let Some(subject) = Subject::of(answer) else { return Ok(found) };
        let levers_missing = found.levers.is_none() && !self.run.no_levers;
        let maps_missing = found.maps.is_empty() && !self.run.no_map;
        let robots_missing = found.robots.is_empty() && own_task(record);
        if !levers_missing && !maps_missing && !robots_missing {
            return Ok(found);
        }
        let maps = MAPPED.len() as f64 * cost::MAP;
        let cost = f64::from(levers_missing) * cost::LEVERS + f64::from(maps_missing) * maps;
        context.begin(cost + f64::from(robots_missing) * cost::WALKED);
        let setup = Setup::from_inputs(&record.inputs(dir)?, &subject.provenance.engine.name)?;
        let design = &subject.design;
        let stiffness = setup.evaluator.predict(design)?;
        let scenario = &setup.evaluator.scenario(setup.only_task()?, design, stiffness)?;
        self.run.pool()?.install(|| {
            if levers_missing {
                let levers = levers(&setup, (design, None), answer.spread_mm, context)?;
                subject.write(dir, LEVERS, &levers)?;
                found.levers = Some(levers);
            }
            if maps_missing {
                let taught = setup.evaluator.taught(scenario, stop)?;
                let map = |axes| map_of(&setup, (scenario, design), taught, axes, context);
                found.maps = MAPPED.into_iter().map(map).collect::<Result<_, _>>()?;
                subject.write(dir, MAPS, &found.maps)?;
            }
            if robots_missing {
                context.part("window with another robot", [0, 1], 0.0);
                found.robots = robots(&setup, answer, scenario, stop)?;
                subject.write(dir, ROBOTS, &found.robots)?;
            }
            Ok::<_, Failure>(())
        })?;
        report::write(dir, answer)?;
        Ok(found)
    }
}

/// Returns the windows of the recommended finger with the study's robot and with a second one: the position-controlled
/// arm if the study's robot is compliant, else the compliant flange. Empty if the finger was not evaluated.
fn robots(
    setup: &Setup,
    answer: &Answer,
    scenario: &Scenario,
    stop: &AtomicBool,
) -> Result<Vec<RobotWindow>, Failure> {
    let start = [scenario.task.turn, scenario.task.strategy.tilt];
    let window_with = |robot: &Robot, measured: Evaluation| {
        let (stiffness_n_per_mm, _) = stiffness_and_lag(robot, start)?;
        Ok::<_, Failure>(RobotWindow { robot: robot.name.clone(), stiffness_n_per_mm, measured })
    };
    let known =
        answer.finger_and_evaluations().and_then(|(_, tasks)| tasks.first().copied().cloned());
    let Some(known) = known else { return Ok(Vec::new()) };
    let own = window_with(&setup.evaluator.robot, known)?;
    let compliant = own.stiffness_n_per_mm.is_some_and(|[_, y, _]| y < COMPLIANT_N_PER_MM);
    let other = robot(if compliant { "ur5e_position" } else { "servo" })?;
    let scenario = &Scenario { robot: other, ..scenario.clone() };
    let found = setup.evaluator.simulate_or_teach(scenario, Search::Walk, stop)?;
    not_stopped(stop)?;
    Ok(vec![own, window_with(&scenario.robot, found)?])
}
