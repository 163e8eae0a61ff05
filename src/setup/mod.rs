//! Setup for the evaluation of designs, and the options from which commands create it.

pub mod bag;
pub mod bench;
pub mod bodies;
pub mod driven;
pub mod files;
pub mod film;
pub mod finger;
pub mod mated;
pub mod measured;
pub mod poses;
pub mod printed;
pub mod repeat;
pub mod request;
pub mod robots;
pub mod run;
pub mod task;
pub mod tune;
pub mod words;

use crate::failure::{Failure, bad_config};
use files::{Fingers, find, surrogate};
use input::Place;
use input::shipped::{ROBOTS, Source, UNCERTAINTIES};
use insertion::evaluation::template::{printable, within_limits};
use insertion::evaluation::uncertainty::Uncertainty;
use insertion::{
    EngineKind, Evaluator, FingerModelKind, FingerSource, Plan, Priors, Robot, Space, Task,
    Template,
};
use measured::Measured;
use std::sync::Arc;
use study::{BENCH_ROLES, CELL, FINGER, Inputs, Provenance, sha256};

/// Setup for the evaluation of designs.
pub struct Setup {
    /// Evaluator of designs.
    pub evaluator: Evaluator,
    fingers: Fingers,
    /// Search space.
    pub space: Space,
    /// Distribution of errors, if there is one.
    pub uncertainty: Option<Uncertainty>,
    /// Bench measurements, if there are any.
    pub measured: Option<Measured>,
    /// Texts of the input files.
    pub inputs: Inputs,
    /// Paths of the task files, as given.
    pub task_files: Vec<String>,
    /// Path of the user's own robot file, as given; else empty.
    pub robot_file: String,
}

/// Keys of the input files other than tasks in [`Inputs`].
const SPACE: &str = "space";
const ROBOT: &str = "robot";
const STIFFNESS_DATA: &str = "stiffness";
const UNCERTAINTY: &str = "uncertainty";

/// Returns the key of a task in [`Inputs`], counted from 1.
fn task_role(number: usize) -> String {
    format!("task_{number}")
}

impl Setup {
    /// Returns the setup of the input copies in a study's folder.
    pub(crate) fn from_inputs(inputs: &Inputs, engine: &str) -> Result<Self, Failure> {
        let engine = <EngineKind as clap::ValueEnum>::from_str(engine, false)
            .map_err(|_| bad_config(format!("unknown engine `{engine}`")))?;
        let task = |number| input(inputs, &task_role(number)).ok();
        let tasks: Vec<Source> = (1..).map_while(task).collect();
        let space = input(inputs, SPACE)?;
        let parsed = Space::parse(&space.text, &space.file)?;
        // Only the inputs of a setup with computed fingers contain a finger file.
        let fingers = Fingers::parse(input(inputs, FINGER).ok())?;
        let others = [&input(inputs, ROBOT)?, &input(inputs, STIFFNESS_DATA)?];
        let mut setup = Setup::new(&tasks, (&space, parsed), others, fingers, engine)?;
        if let Ok(source) = input(inputs, CELL) {
            let found = cell(&source)?;
            setup = setup.with_cell(source, found)?;
        }
        if let Ok(source) = input(inputs, UNCERTAINTY) {
            setup = setup.with_uncertainty(source)?;
        }
        let [measurements, priors] = BENCH_ROLES;
        match input(inputs, measurements) {
            Ok(lines) => setup.with_measurements(lines, input(inputs, priors)?),
            Err(_) => Ok(setup),
        }
    }

    pub(crate) fn new(
        tasks: &[Source],
        (space_source, space): (&Source, Space),
        others: [&Source; 2],
        fingers: Fingers,
        engine: EngineKind,
    ) -> Result<Self, Failure> {
        let [robot_source, stiffness_source] = others;
        let robot = Robot::parse(&robot_source.text, &robot_source.file)?;
        let template =
            |task: &Source| Template::parse(&task.text, &task.file).map_err(Failure::task);
        let templates = tasks.iter().map(template).collect::<Result<Vec<_>, Failure>>()?;
        check_distinct(&templates)?;
        let space = within_limits(space, &templates);
        let roles = (1..).map(task_role).zip(tasks);
        let others = [SPACE, ROBOT, STIFFNESS_DATA].map(str::to_owned).into_iter();
        let others = others.zip([space_source, robot_source, stiffness_source]);
        let finger = fingers.source.iter().map(|source| (FINGER.to_owned(), source));
        let sources = roles.chain(others).chain(finger);
        let inputs = sources.map(|(role, source)| (role, source.text.clone())).collect();
        let surrogate = surrogate(stiffness_source, &fingers.file.finger)?;
        let finger_source = fingers.finger_source();
        let evaluator =
            Evaluator { surrogate, fingers: finger_source, templates, robot, engine, cell: None };
        check_compatible(&evaluator, &space, &space_source.file)?;
        let task_files = tasks.iter().map(|task| task.file.clone()).collect();
        let (uncertainty, measured) = (None, None);
        let shipped = ROBOTS.iter().any(|known| known.text == robot_source.text);
        let robot_file = if shipped { String::new() } else { robot_source.file.clone() };
        Ok(Setup {
            inputs,
            evaluator,
            fingers,
            uncertainty,
            measured,
            space,
            task_files,
            robot_file,
        })
    }

    /// Returns an evaluator with stiffnesses computed from the ribs of the shipped finger; `None` if the setup does
    /// not use the finger model of the paper, or if space, tasks or engine do not support computed fingers.
    pub(crate) fn by_ribs(&self) -> Option<Evaluator> {
        let own = &self.evaluator;
        if own.fingers.kind() != FingerModelKind::Paper {
            return None;
        }
        let (surrogate, fingers) = (Arc::clone(&own.surrogate), self.fingers.computed());
        let (templates, robot, engine) = (own.templates.clone(), own.robot.clone(), own.engine);
        let cell = own.cell.clone();
        let evaluator = Evaluator { surrogate, fingers, templates, robot, engine, cell };
        check_compatible(&evaluator, &self.space, SPACE).ok()?;
        Some(evaluator)
    }

    /// Returns the setup with the parameters of this cell, including those of its robot.
    pub(crate) fn with_cell(mut self, source: Source, cell: Priors) -> Result<Self, Failure> {
        cell.parameters.iter().for_each(|row| self.evaluator.robot.change(row, row.middle()));
        self.evaluator.cell = Some(cell);
        self.evaluator.check_cell(&source.file)?;
        self.inputs.insert(CELL.to_owned(), source.text);
        Ok(self)
    }

    /// Returns the setup with the distribution of errors of that name.
    pub(crate) fn with_named_uncertainty(self, name: &str) -> Result<Self, Failure> {
        self.with_uncertainty(find("uncertainty", UNCERTAINTIES, name)?)
    }

    fn with_uncertainty(mut self, errors: Source) -> Result<Self, Failure> {
        let uncertainty = Uncertainty::parse(&errors.text, &errors.file)?;
        if let Some(cell) = &uncertainty.cell {
            self.evaluator.check_paths(cell, &errors.file)?;
        }
        let robot = &self.evaluator.robot;
        let rows = uncertainty.cell.iter().filter(|cell| cell.robot.is_none());
        let mut rows = rows.flat_map(|cell| &cell.parameters);
        if let Some(row) = rows.find(|row| !robot.fits(row)) {
            let problem =
                format!("needs a robot of kind = \"servo\"; `{}` is of another kind", robot.name);
            return Err(Failure::input(Place::file(&errors.file).key(&row.name).fault(problem)));
        }
        self.uncertainty = Some(uncertainty);
        self.inputs.insert(UNCERTAINTY.to_owned(), errors.text);
        Ok(self)
    }

    /// Returns the setup with bench measurements of its task.
    pub(crate) fn with_measurements(
        mut self,
        lines: Source,
        priors: Source,
    ) -> Result<Self, Failure> {
        let experiments = measured::lines(&lines, &self.task_names())?;
        let file = lines.file;
        if let [template] = self.evaluator.templates.as_slice() {
            measured::check(&file, &experiments, template, &self.space)?;
        }
        let [role, priors_role] = BENCH_ROLES.map(str::to_owned);
        let bounds = Priors::parse(&priors.text, &priors.file)?;
        self.evaluator.check_paths(&bounds, &priors.file)?;
        let measured = Measured { priors: bounds, experiments, file };
        self.inputs.extend([(role, lines.text), (priors_role, priors.text)]);
        self.measured = Some(measured);
        Ok(self)
    }

    /// Returns the names of the tasks.
    pub fn task_names(&self) -> Vec<&str> {
        self.evaluator.templates.iter().map(|template| template.task.name.as_str()).collect()
    }

    /// Returns the provenance that a study records.
    pub fn provenance(&self) -> Provenance {
        Provenance::new(self.evaluator.engine, sha256(&self.inputs))
    }

    /// Returns the task of a command that takes only one.
    ///
    /// # Errors
    /// If there are several.
    pub fn only_task(&self) -> Result<&Template, Failure> {
        match self.evaluator.templates.as_slice() {
            [template] => Ok(template),
            _ => Err(Failure::usage("give one --task; only a study may have several")),
        }
    }

    /// Returns the plan of the trials for success rates, robust ranges or both, under errors drawn with this seed.
    ///
    /// # Errors
    /// If there is no distribution of errors.
    pub fn plan(&self, seed: u64, [success, robust]: [bool; 2]) -> Result<Plan, Failure> {
        match &self.uncertainty {
            Some(uncertainty) => Ok(Plan::new(uncertainty, seed, success, robust)),
            None if success || robust => Err(missing(UNCERTAINTY)),
            None => Ok(Plan::WINDOW),
        }
    }
}

/// Checks that robot, engine, fingers and space (of `file`) are compatible with each task.
fn check_compatible(evaluator: &Evaluator, space: &Space, file: &str) -> Result<(), Failure> {
    let Evaluator { fingers, templates, robot, engine, .. } = evaluator;
    if let FingerSource::Computed(fingers) = fingers {
        printable::check(space, file, &fingers.file)?;
    }
    let fits = |task: &Task| engine.rig(task, robot, &fingers.example(task), 1.0).map(|_| ());
    for template in templates {
        fits(&template.task)?;
        template.check(space, file, &fits)?;
    }
    printable::check_springs(evaluator, space, file).map_err(Failure::input)
}

/// Checks that no task is given twice.
fn check_distinct(templates: &[Template]) -> Result<(), Failure> {
    let names: Vec<&str> = templates.iter().map(|template| &*template.task.name).collect();
    let twice = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name));
    twice.map_or(Ok(()), |(_, twice)| {
        Err(Failure::usage(format!("two tasks are called `{twice}`; give each task once")))
    })
}

/// Parses a cell file, which must contain a robot.
pub(crate) fn cell(Source { file, text }: &Source) -> Result<Priors, Failure> {
    let cell = Priors::parse(text, file)?;
    match cell.robot {
        Some(_) => Ok(cell),
        None => Err(Failure::in_file(
            file,
            "robot: missing; a cell needs a section [robot] with the keys of a robot file",
        )),
    }
}

fn missing(role: &str) -> Failure {
    bad_config(format!("input_sha256 has no `{role}`"))
}

/// Returns an input of a study's folder.
///
/// # Errors
/// If it is missing.
pub fn input(inputs: &Inputs, role: &str) -> Result<Source, Failure> {
    let text = inputs.get(role).cloned().ok_or_else(|| missing(role))?;
    Ok(Source { file: format!("inputs/{role}"), text })
}
