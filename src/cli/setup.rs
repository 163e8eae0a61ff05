//! From names on the command line to things that can be run: the one place
//! where tasks, robots, engines, surrogate and optimizers are put together.

use super::Failure;
use crate::evaluation::objective::Measure;
use crate::evaluation::robustness::Plan;
use crate::evaluation::template::Template;
use crate::evaluation::uncertainty::Uncertainty;
use crate::input::robot::Robot;
use crate::input::shipped::{self, ROBOTS, SPACES, STIFFNESS, Shipped, Source, TASKS};
use crate::input::space::{DENSITY_KEY, DIRECTION_KEY, Design, Space};
use crate::input::stiffness;
use crate::input::task::Task;
use crate::optimizer::gp::DEFAULT_NOISE_FLOOR;
use crate::optimizer::{self, Grid, Optimizer, Polished};
use crate::physics::Engine;
use crate::physics::direct::Direct;
#[cfg(feature = "mujoco")]
use crate::physics::mujoco::Mujoco;
use crate::physics::rapier::Rapier;
use crate::study::{Inputs, StudyConfig, Versions};
use crate::surrogate::{self, Model, Prediction};
use crate::trial::Rig;
use crate::trial::fake::FakeRig;
use crate::trial::run::{EngineRig, RigError};
use clap::ValueEnum;
use std::time::Duration;

pub use crate::optimizer::OptimizerKind;

/// Robot used unless another is named.
pub const DEFAULT_ROBOT: &str = "servo";
/// Contact engine used unless another is named.
pub const DEFAULT_ENGINE: &str = "direct";
/// Search space used unless another is named.
pub const DEFAULT_SPACE: &str = "infill";
/// The contact engine's version, as pinned in Cargo.toml.
const RAPIER_VERSION: &str = "0.36.1";
/// MuJoCo's version, as pinned in Cargo.toml and scripts/mujoco.sh.
#[cfg(feature = "mujoco")]
const MUJOCO_VERSION: &str = "3.17.0";
/// Microseconds each trial of the fake engine takes, for tests that interrupt studies.
const FAKE_DELAY: &str = "FINGER_OPT_FAKE_DELAY_US";

/// What computes the contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EngineKind {
    /// Contact simulation in rapier3d
    Rapier,
    /// Implicit stepper made for sprung fingers and rigid contacts
    Direct,
    /// MuJoCo 3.17.0, as a second opinion
    #[cfg(feature = "mujoco")]
    Mujoco,
    /// A closed formula, for tests
    #[value(hide = true)]
    Fake,
}

impl EngineKind {
    /// Its name on the command line and in study files.
    pub fn name(self) -> &'static str {
        match self {
            EngineKind::Rapier => "rapier",
            EngineKind::Direct => "direct",
            #[cfg(feature = "mujoco")]
            EngineKind::Mujoco => "mujoco",
            EngineKind::Fake => "fake",
        }
    }

    /// The engine with its production step times `factor`; `None` for the fake.
    pub fn build(self, factor: f64) -> Option<Box<dyn Engine>> {
        match self {
            EngineKind::Rapier => {
                let mut engine = Rapier::default();
                engine.settings.step_s *= factor;
                Some(Box::new(engine))
            }
            EngineKind::Direct => {
                let mut engine = Direct::default();
                engine.settings.step_s *= factor;
                Some(Box::new(engine))
            }
            #[cfg(feature = "mujoco")]
            EngineKind::Mujoco => {
                let mut engine = Mujoco::default();
                engine.settings.step_s *= factor;
                Some(Box::new(engine))
            }
            EngineKind::Fake => None,
        }
    }

    /// All its settings, in words.
    pub fn settings(self) -> String {
        match self {
            EngineKind::Rapier => format!("{:?}", Rapier::default()),
            EngineKind::Direct => format!("{:?}", Direct::default()),
            #[cfg(feature = "mujoco")]
            EngineKind::Mujoco => format!("{:?}", Mujoco::default()),
            EngineKind::Fake => self.name().to_owned(),
        }
    }

    /// What computes with this engine.
    pub fn versions(self) -> Versions {
        let engine = match self {
            EngineKind::Rapier | EngineKind::Direct => RAPIER_VERSION,
            #[cfg(feature = "mujoco")]
            EngineKind::Mujoco => MUJOCO_VERSION,
            EngineKind::Fake => "1",
        };
        Versions { program: env!("CARGO_PKG_VERSION").to_owned(), engine: engine.to_owned() }
    }
}

/// What a trial, an evaluation and a study have in common on the command line.
#[derive(Debug, Clone, clap::Args)]
pub struct SetupArguments {
    /// Task: ket8, ket12, rj45, usb, or the path of a task file; a study may have several, by commas
    #[arg(long, value_name = "NAME")]
    pub task: String,
    /// Search space: infill, codesign, or the path of a space file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_SPACE)]
    pub space: String,
    /// Robot: see `optimize tasks`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    pub robot: String,
    /// Your own stiffness measurements in place of the shipped ones
    #[arg(long, value_name = "FILE.csv")]
    pub stiffness_data: Option<String>,
    /// Contact engine
    #[arg(long, value_enum, default_value = DEFAULT_ENGINE)]
    pub engine: EngineKind,
}

/// Everything that is needed to measure a design.
pub struct Setup {
    /// The task, whose numbers a design may set.
    pub template: Template,
    /// The tasks beside it.
    pub other_templates: Vec<Template>,
    pub robot: Robot,
    pub space: Space,
    pub engine: EngineKind,
    pub surrogate: Surrogate,
    /// The errors under which designs are measured, if they are.
    pub uncertainty: Option<Uncertainty>,
    /// The texts all this was read from.
    pub inputs: Inputs,
}

impl Setup {
    /// Reads and checks the files the arguments name.
    pub fn from_arguments(arguments: &SetupArguments) -> Result<Self, Failure> {
        let names = arguments.task.split(',').map(str::trim);
        let tasks = names.map(|name| find("task", TASKS, name)).collect::<Result<_, _>>()?;
        let space = find("space", SPACES, &arguments.space)?;
        let robot = find("robot", ROBOTS, &arguments.robot)?;
        let stiffness = stiffness_data(arguments.stiffness_data.as_deref())?;
        Setup::parse(tasks, [space, robot, stiffness], arguments.engine)
    }

    /// The same from the copies kept in a study's folder.
    pub fn from_inputs(inputs: &Inputs, engine: &str) -> Result<Self, Failure> {
        let engine = EngineKind::from_str(engine, false)
            .map_err(|_| Failure::usage(format!("study.toml: no engine is called `{engine}`")))?;
        let first = input(inputs, TASK)?;
        let others = (2..).map(other_task).take_while(|role| inputs.contains_key(role));
        let others = others.map(|role| input(inputs, &role));
        let tasks = std::iter::once(Ok(first)).chain(others).collect::<Result<_, _>>()?;
        let [space, robot, stiffness] = OTHERS.map(|role| input(inputs, role));
        let setup = Setup::parse(tasks, [space?, robot?, stiffness?], engine)?;
        match inputs.contains_key(UNCERTAINTY) {
            true => setup.under(input(inputs, UNCERTAINTY)?),
            false => Ok(setup),
        }
    }

    fn parse(tasks: Vec<Source>, others: [Source; 3], engine: EngineKind) -> Result<Self, Failure> {
        let [space, robot, stiffness] = &others;
        let file = &space.file;
        let space = Space::parse(&space.text, file).map_err(Failure::input)?;
        let robot = Robot::parse(&robot.text, &robot.file).map_err(Failure::input)?;
        let fits = |task: &Task| rig(engine, task, &robot).map(|_| ());
        let template = |task: &Source| {
            let template = Template::parse(&task.text, &task.file).map_err(Failure::input)?;
            fits(template.task()).map_err(Failure::input)?;
            template.check(&space, file, &fits).map_err(Failure::input)?;
            Ok(template)
        };
        let mut templates = tasks.iter().map(template).collect::<Result<Vec<_>, Failure>>()?;
        different(&templates)?;
        let roles = std::iter::once(TASK.to_owned()).chain((2..).map(other_task)).zip(&tasks);
        let others = OTHERS.map(str::to_owned).into_iter().zip(&others);
        let inputs = roles.chain(others).map(|(role, source)| (role, source.text.clone()));
        Ok(Setup {
            // A list split at commas has at least one entry.
            template: templates.remove(0),
            other_templates: templates,
            surrogate: surrogate(stiffness)?,
            engine,
            uncertainty: None,
            inputs: inputs.collect(),
            robot,
            space,
        })
    }

    /// The same with errors under which designs are measured.
    pub fn under(mut self, errors: Source) -> Result<Self, Failure> {
        let uncertainty = Uncertainty::parse(&errors.text, &errors.file).map_err(Failure::input)?;
        self.uncertainty = Some(uncertainty);
        self.inputs.insert(UNCERTAINTY.to_owned(), errors.text);
        Ok(self)
    }

    /// All templates, in the order of the tasks.
    pub fn templates(&self) -> impl Iterator<Item = &Template> {
        std::iter::once(&self.template).chain(&self.other_templates)
    }

    /// What is measured beside the window, with the draws of this seed; `wanted` says which.
    pub fn plan(&self, seed: u64, wanted: impl Fn(Measure) -> bool) -> Result<Plan, Failure> {
        let (success, robust) = (wanted(Measure::SuccessRate), wanted(Measure::RobustRange));
        match &self.uncertainty {
            Some(uncertainty) => Ok(Plan::new(uncertainty, seed, success, robust)),
            None if success || robust => Err(missing(UNCERTAINTY)),
            None => Ok(Plan::WINDOW),
        }
    }

    /// Where trials of a task with this robot are run.
    pub fn rig(&self, task: &Task) -> Result<Box<dyn Rig>, RigError> {
        rig(self.engine, task, &self.robot)
    }

    /// The same with the engine's step times `factor`.
    pub fn rig_at(&self, task: &Task, factor: f64) -> Result<Box<dyn Rig>, RigError> {
        rig_at(self.engine, task, &self.robot, factor)
    }
}

/// Roles of the input files: the first task, those beside task and errors, and the errors.
const TASK: &str = "task";
const OTHERS: [&str; 3] = ["space", "robot", "stiffness"];
const UNCERTAINTY: &str = "uncertainty";

/// The role of the second task and so on.
fn other_task(number: usize) -> String {
    format!("{TASK}_{number}")
}

/// A task that is given twice would count twice.
fn different(templates: &[Template]) -> Result<(), Failure> {
    let names: Vec<&str> = templates.iter().map(|template| &*template.task().name).collect();
    match names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
        None => Ok(()),
        Some((_, twice)) => {
            Err(Failure::usage(format!("two tasks are called `{twice}`; give each task once")))
        }
    }
}

fn missing(role: &str) -> Failure {
    Failure::usage(format!("study.toml: input_sha256 has no `{role}`"))
}

/// One of the inputs kept in a study's folder.
pub fn input(inputs: &Inputs, role: &str) -> Result<Source, Failure> {
    match inputs.get(role) {
        Some(text) => Ok(Source { file: format!("inputs/{role}"), text: text.clone() }),
        None => Err(missing(role)),
    }
}

/// The measurements the surrogate is fitted to.
pub fn stiffness_data(path: Option<&str>) -> Result<Source, Failure> {
    find("stiffness data", STIFFNESS, path.unwrap_or("measured"))
}

/// The shipped file of that name, or the file at that path.
pub fn find(kind: &'static str, shipped: &[Shipped], name: &str) -> Result<Source, Failure> {
    shipped::resolve(kind, shipped, name).map_err(Failure::input)
}

/// The robot of that name, or of the file at that path.
pub fn robot(name: &str) -> Result<Robot, Failure> {
    let source = find("robot", ROBOTS, name)?;
    Robot::parse(&source.text, &source.file).map_err(Failure::input)
}

/// Where trials of one task with one robot are run, if the three go together.
pub fn rig(engine: EngineKind, task: &Task, robot: &Robot) -> Result<Box<dyn Rig>, RigError> {
    rig_at(engine, task, robot, 1.0)
}

fn rig_at(
    engine: EngineKind,
    task: &Task,
    robot: &Robot,
    factor: f64,
) -> Result<Box<dyn Rig>, RigError> {
    if let Some(engine) = engine.build(factor) {
        return Ok(Box::new(EngineRig::new(task.clone(), robot, engine)?));
    }
    let delay = std::env::var(FAKE_DELAY).ok().and_then(|text| text.parse().ok());
    Ok(Box::new(FakeRig { delay: Duration::from_micros(delay.unwrap_or(0)) }))
}

/// The stiffness model.
pub struct Surrogate(pub Model);

impl Surrogate {
    /// Stiffness predicted for a design, which must name the infill.
    pub fn predict(&self, design: &Design) -> Prediction {
        let value = |key| design.get(key).unwrap_or(f64::NAN);
        self.0.predict(value(DENSITY_KEY), value(DIRECTION_KEY))
    }
}

/// Fits the stiffness model to a CSV of measurements.
pub fn surrogate(data: &Source) -> Result<Surrogate, Failure> {
    let measurements = stiffness::parse(&data.text, &data.file).map_err(Failure::input)?;
    let fitted = surrogate::fit(&measurements)
        .map_err(|error| Failure::usage(format!("{}: {error}", data.file)))?;
    Ok(Surrogate(fitted))
}

/// The optimizer of a study.
pub fn optimizer(
    kind: OptimizerKind,
    setup: &Setup,
    config: &StudyConfig,
) -> Box<dyn Optimizer + Send> {
    let grid = Grid::new(setup.space.levels());
    let measures = config.objective.measures().iter();
    let floors: Vec<f64> =
        measures.map(|&measure| noise_floor(measure, setup.uncertainty.as_ref())).collect();
    let search = optimizer::build_for(kind, grid.clone(), config.seed, &floors);
    match config.polish {
        0 => search,
        polish => Box::new(Polished::new(search, grid, config.budget, polish)),
    }
}

/// Standard deviation of what a measure's steps round off, in its unit: ranges have steps of
/// 0.1 mm, success rates of one trial, forces and slips none.
fn noise_floor(measure: Measure, uncertainty: Option<&Uncertainty>) -> f64 {
    match measure {
        Measure::PeakForce | Measure::Slip => 0.0,
        Measure::Range | Measure::CentredRange | Measure::RobustRange => DEFAULT_NOISE_FLOOR,
        Measure::SuccessRate => {
            let trials = uncertainty.map_or(1, |errors| errors.success.trials);
            1.0 / f64::from(trials) / 12f64.sqrt()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_engine_version_is_the_pinned_one() {
        let pin = format!("rapier3d-f64 = {{ version = \"={RAPIER_VERSION}\"");
        assert!(include_str!("../../Cargo.toml").contains(&pin));
    }
}
