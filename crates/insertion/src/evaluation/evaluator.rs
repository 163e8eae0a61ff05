//! Evaluation of designs: their scenarios, rigs and measurements.

use super::cell::{Priors, change};
use super::robustness::firm::{self, FirmResult};
use super::robustness::race::Race;
use super::robustness::repeat::Repeats;
use super::robustness::{self, Drawn, Plan};
use super::taught::{Shifted, teach};
use super::template::{DesignError, Template};
use super::tolerance::Search;
use super::{Evaluation, OffsetStep, shape_correction};
use crate::finger::model::{CentreSource, RCC_KEY};
use crate::surrogate::Model;
use crate::trial::run::RigError;
use crate::{
    DENSITY_KEY, DIRECTION_KEY, Design, EngineKind, Finger, FingerSource, Grasp, Outcome,
    Prediction, Rig, Robot, StartRule, Task,
};
use input::numbers::DESIGN;
use input::units::N_PER_MM;
use parameters::{Parameter, numbers};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Models, tasks, robot, engine and cell: everything that determines the evaluation of a design.
///
/// ```
/// use finray::printed::PrintedFinger;
/// use input::shipped::{FINGERS, ROBOTS, STIFFNESS, TASKS};
/// use insertion::evaluation::{evaluator::Evaluator, template::Template};
/// use insertion::finger::model::FingerSource;
/// use insertion::{robot::Robot, space::Design, stiffness, surrogate, trial::engine::EngineKind};
/// let measured = stiffness::parse(STIFFNESS[0].text, STIFFNESS[0].file)?;
/// let printed = PrintedFinger::parse(FINGERS[0].text, FINGERS[0].file)?;
/// let evaluator = Evaluator {
///     surrogate: surrogate::fit(&measured, &printed)?.into(),
///     fingers: FingerSource::Paper,
///     templates: vec![Template::parse(TASKS[0].text, TASKS[0].file)?],
///     robot: Robot::parse(ROBOTS[0].text, ROBOTS[0].file)?,
///     engine: EngineKind::Direct,
///     cell: None,
/// };
/// let design = Design::infill(20.0, 10.0);
/// let stiffness = evaluator.predict(&design)?;
/// let scenario = evaluator.scenario(&evaluator.templates[0], &design, stiffness)?;
/// assert!(scenario.finger.assembly > 10.0 * scenario.finger.compliance);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Evaluator {
    /// Stiffness model of the infill.
    pub surrogate: Arc<Model>,
    /// Finger model of all designs.
    pub fingers: FingerSource,
    /// Task files whose numbers a design may set; at least one.
    pub templates: Vec<Template>,
    /// Robot that carries the fingers.
    pub robot: Robot,
    /// Contact engine.
    pub engine: EngineKind,
    /// Robot cell whose identified or nominal values replace numbers that a design does not set. If a cell is given,
    /// `robot` is its robot.
    pub cell: Option<Priors>,
}

/// Design with the task, finger and robot that result from its numbers and those of the cell, ready for simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// Task with the numbers of the design and the cell.
    pub task: Task,
    /// Design.
    pub design: Design,
    /// Finger of the design.
    pub finger: Finger,
    /// Predicted stiffness of the finger, with its standard deviation.
    pub stiffness: Prediction,
    /// Robot that carries the finger.
    pub robot: Robot,
}

impl Scenario {
    /// Returns the source of the finger's remote centre.
    pub fn centre_source(&self) -> CentreSource {
        match (self.design.get(RCC_KEY), self.task.finger.rcc) {
            (Some(_), _) => CentreSource::Design,
            (None, Some(_)) => CentreSource::Task,
            (None, None) => CentreSource::FingerModel,
        }
    }
}

/// Scenario, and the shift of its taught start, grid steps.
pub type Started = (Scenario, Option<OffsetStep>);

/// Evaluations of one design on all tasks.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluations {
    /// Predicted stiffness.
    pub stiffness: Prediction,
    /// Evaluation on each task, in the order of the tasks.
    pub tasks: Vec<Evaluation>,
    /// Whether each evaluation came from the cache; empty without a cache.
    pub cached: Vec<bool>,
}

/// Interface for the evaluation of designs from several threads.
pub trait Evaluate: Sync {
    /// Evaluates a design. A lost race ends the trials of its success rate early. Equal designs and races give equal
    /// results.
    fn evaluate(&self, design: &Design, race: Option<&Race>) -> Result<Evaluations, DesignError>;
}

impl Evaluator {
    /// Returns the predicted stiffness of a design with an infill.
    pub fn predict(&self, design: &Design) -> Result<Prediction, DesignError> {
        let value = |key| design.get(key).unwrap_or(f64::NAN);
        let infill = self.surrogate.predict([DENSITY_KEY, DIRECTION_KEY].map(value))?;
        let FingerSource::Computed(fingers) = &self.fingers else { return Ok(infill) };
        let measured = &self.surrogate.measurements;
        let design = &self.completed(None, design, &self.rows(None));
        Ok(shape_correction::predict(fingers, measured, design, infill)?)
    }

    /// Returns the scenario of a design with the given stiffness on one of the tasks.
    pub fn scenario(
        &self,
        template: &Template,
        design: &Design,
        stiffness: Prediction,
    ) -> Result<Scenario, DesignError> {
        self.scenario_under(template, design, stiffness, &self.rows(Some(template)))
    }

    /// Returns the scenario with these values of a cell's parameters for the numbers that the design does not set.
    pub(super) fn scenario_under(
        &self,
        template: &Template,
        design: &Design,
        stiffness: Prediction,
        rows: &[(&Parameter, f64)],
    ) -> Result<Scenario, DesignError> {
        for (key, axis) in [
            ("stiffness_compliance_n_per_mm", stiffness.compliance),
            ("stiffness_assembly_n_per_mm", stiffness.assembly),
        ] {
            // Far from the measured designs the model may predict any value.
            numbers::check(DESIGN, key, axis.mean / N_PER_MM)?;
            DESIGN.not_negative(key, axis.sd / N_PER_MM)?;
        }
        let set = self.completed(Some(template), design, rows);
        let (task, finger) = template.apply(&set, &self.fingers, &stiffness)?;
        let robot = self.robot.clone();
        let mut scenario = Scenario { task, design: design.clone(), finger, stiffness, robot };
        for (row, value) in rows.iter().filter(|(row, _)| design.get(&row.path).is_none()) {
            change(row, *value, &mut scenario);
        }
        Ok(scenario)
    }

    /// Returns the shift of a scenario's taught start, grid steps; `None` if its task has no taught start, 0 if
    /// no start inserts. The result is invalid once `stop` is set.
    pub fn taught(
        &self,
        scenario: &Scenario,
        stop: &AtomicBool,
    ) -> Result<Option<OffsetStep>, RigError> {
        if scenario.task.strategy.rule == StartRule::Given {
            return Ok(None);
        }
        let rig = self.rig(scenario, None, 1.0)?;
        Ok(Some(teach(&*rig, &scenario.finger, stop).map_or(0, |taught| taught.shift)))
    }

    /// Returns the rig of a scenario, with its start shifted to the taught one if given, and `step_factor` times the
    /// time step.
    pub fn rig(
        &self,
        Scenario { task, finger, robot, .. }: &Scenario,
        taught: Option<OffsetStep>,
        step_factor: f64,
    ) -> Result<Box<dyn Rig>, RigError> {
        let rig = self.engine.rig(task, robot, finger, step_factor)?;
        match taught {
            None | Some(0) => Ok(rig),
            Some(shift) => Ok(Box::new(Shifted { rig, shift })),
        }
    }

    /// Simulates a scenario according to a plan. The result is invalid once `stop` is set.
    pub fn simulate(
        &self,
        scenario: &Scenario,
        search: Search,
        plan: &Plan,
        stop: &AtomicBool,
    ) -> Result<Evaluation, DesignError> {
        let taught = self.taught(scenario, stop)?;
        let rig = self.rig(scenario, taught, 1.0)?;
        let grasp = Grasp { stop, ..Grasp::of(&scenario.finger) };
        let draw = |(cell, values): (&Priors, &Vec<f64>)| -> Result<Drawn, DesignError> {
            let drawn = self.in_cell(scenario, cell, values)?;
            Ok((self.rig(&drawn, taught, 1.0)?, drawn.finger))
        };
        let draws = plan.cells.iter().flat_map(|(cell, all)| all.iter().map(move |v| (cell, v)));
        let cells: Vec<Drawn> = draws.map(draw).collect::<Result<_, _>>()?;
        let predicted = &scenario.stiffness;
        let evaluation = robustness::evaluate(&*rig, grasp, predicted, search, plan, &cells);
        Ok(Evaluation { taught, ..evaluation })
    }

    /// Simulates the window of a scenario, with a taught start if the nominal start fails.
    pub fn simulate_or_teach(
        &self,
        scenario: &Scenario,
        search: Search,
        stop: &AtomicBool,
    ) -> Result<Evaluation, DesignError> {
        let evaluation = self.simulate(scenario, search, &Plan::WINDOW, stop)?;
        if evaluation.window.nominal == Outcome::Inserted {
            return Ok(evaluation);
        }
        let mut taught = scenario.clone();
        taught.task.strategy.rule = StartRule::Taught;
        self.simulate(&taught, search, &Plan::WINDOW, stop)
    }

    /// Measures the [firm window](firm) of a scenario by [`firm::REPEATS`] repeats; `measured` has its window. The
    /// result is invalid once `stop` is set.
    pub fn firm(
        &self,
        scenario: &Scenario,
        measured: &Evaluation,
        seed: u64,
        stop: &AtomicBool,
    ) -> Result<FirmResult, RigError> {
        if measured.window.nominal != Outcome::Inserted {
            return Ok(FirmResult::default());
        }
        let started = [(scenario.clone(), measured.taught)];
        self.repeated(&started, (seed, firm::REPEATS), stop, |repeats| {
            firm::measure(repeats, &measured.window)
        })
    }

    /// Returns a scenario with `count` draws of the cell's parameters, the same for all designs, each with its own
    /// taught start, and the number of draws left out because the task cannot exist with them. Without a cell or a
    /// possible draw returns the scenario with the given taught start. Calls `progress` with the numbers of starts taught
    /// and to teach. The result is invalid once `stop` is set.
    pub fn drawn(
        &self,
        scenario: &Scenario,
        taught: Option<OffsetStep>,
        (seed, count): (u64, u32),
        stop: &AtomicBool,
        progress: impl Fn([usize; 2]) + Sync,
    ) -> Result<(Vec<Started>, usize), RigError> {
        let Some(cell) = &self.cell else { return Ok((vec![(scenario.clone(), taught)], 0)) };
        let draws = parameters::draws(&cell.parameters, seed, count);
        // Such as with a plug wider than its opening.
        let possible = draws.iter().filter_map(|values| self.in_cell(scenario, cell, values).ok());
        let scenarios: Vec<Scenario> = possible.collect();
        let (done, of) = (AtomicUsize::new(0), scenarios.len());
        let started = |one: Scenario| {
            let taught = self.taught(&one, stop)?;
            if taught.is_some() {
                progress([done.fetch_add(1, Ordering::Relaxed) + 1, of]);
            }
            Ok((one, taught))
        };
        let mut started: Vec<_> =
            scenarios.into_par_iter().map(started).collect::<Result<_, RigError>>()?;
        if started.is_empty() {
            started.push((scenario.clone(), taught));
        }
        Ok((started, draws.len() - of))
    }

    /// Calls `measure` with `count` repeats of scenarios from their taught starts, in turn, every other one at half the
    /// time step.
    pub fn repeated<T>(
        &self,
        started: &[Started],
        (seed, count): (u64, u32),
        stop: &AtomicBool,
        measure: impl FnOnce(&Repeats) -> T,
    ) -> Result<T, RigError> {
        // A single scenario has both steps.
        let started = started.iter().cycle().take(started.len().max(2)).enumerate();
        let rig = |(index, (one, shift)): (usize, &Started)| {
            let rig = self.rig(one, *shift, [1.0, 0.5][index % 2])?;
            Ok((rig, Grasp { stop, ..Grasp::of(&one.finger) }))
        };
        let rigs: Vec<_> = started.map(rig).collect::<Result<_, RigError>>()?;
        let rigs: Vec<_> = rigs.iter().map(|(rig, grasp)| (&**rig, *grasp)).collect();
        Ok(measure(&Repeats::new(&rigs, seed, count)))
    }

    /// Evaluates a design on every task with `measure`.
    pub fn evaluate_by(
        &self,
        design: &Design,
        mut measure: impl FnMut(&Scenario) -> Result<Evaluation, DesignError>,
    ) -> Result<Evaluations, DesignError> {
        let stiffness = self.predict(design)?;
        let on = |template| measure(&self.scenario(template, design, stiffness)?);
        let tasks = self.templates.iter().map(on).collect::<Result<_, DesignError>>()?;
        Ok(Evaluations { stiffness, tasks, cached: Vec::new() })
    }
}
