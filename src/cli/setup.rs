//! From names on the command line to what a command works with.

use super::Failure;
use super::measured::{self, Measured};
use crate::study::{BENCH_ROLES, FINGER, Inputs, Provenance, sha256};
use finray::printed::PrintedFinger;
use input::shipped::{self, FINGERS, ROBOTS, SPACES, STIFFNESS, Shipped, Source, TASKS};
use insertion::evaluation::evaluator::Evaluator;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::sprung;
use insertion::evaluation::template::{Template, printable};
use insertion::evaluation::uncertainty::Uncertainty;
use insertion::finger::Finger;
use insertion::finger::computed::Touching;
use insertion::finger::file::{FingerFile, is_shape};
use insertion::finger::model::{ComputedFingers, FingerModelKind, FingerSource};
use insertion::robot::Robot;
use insertion::space::{Parameter, Space};
use insertion::stiffness;
use insertion::surrogate::{self, FitError, Model};
use insertion::task::{StartRule, Task};
use insertion::trial::Rig;
use insertion::trial::run::RigError;
use std::path::Path;
use std::sync::Arc;

pub use insertion::trial::engine::EngineKind;

/// Robot used unless another is named.
pub const DEFAULT_ROBOT: &str = "servo";
/// Contact engine used unless another is named.
pub const DEFAULT_ENGINE: &str = "direct";
/// Finger file used unless another is named.
pub const DEFAULT_FINGER: &str = "finray9";
/// What presses the pad of a computed finger; why is in `docs/notes/finger.md`.
pub const TOUCHING: Touching = Touching::PadAndRoof;
/// Search space used unless another is named.
pub const DEFAULT_SPACE: &str = "infill";

/// What a trial, an evaluation and a study have in common on the command line.
#[derive(Debug, Clone, clap::Args)]
pub struct SetupArguments {
    /// Task: ket8, ket12, rj45, usb, or the path of a task file; a study may have several, by commas
    #[arg(long, value_name = "NAME")]
    pub task: String,
    /// Search space: infill, codesign, finger, or the path of a space file
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
    #[command(flatten)]
    pub finger_model: FingerModelArguments,
    /// What becomes of the nominal start, in place of what the task file says
    #[arg(long, value_enum)]
    pub start: Option<StartRule>,
    /// Task files in place of those that `--task` names; only a caller can give them.
    #[arg(skip)]
    pub given: Vec<Source>,
}

/// Where the springs of a finger come from that were not measured.
#[derive(Debug, Clone, clap::Args)]
pub struct FingerModelArguments {
    /// Where a finger's remote centre and unmeasured springs come from [default: paper; computed
    /// for a space with numbers of the printed finger]
    #[arg(long = "finger-model", value_enum)]
    pub kind: Option<FingerModelKind>,
    /// Finger file of --finger-model computed: finray9, or the path of one
    #[arg(long, value_name = "NAME", default_value = DEFAULT_FINGER)]
    pub finger: String,
}

impl FingerModelArguments {
    /// The finger file, if fingers are computed: as those of a space with numbers of a printed
    /// finger have to be.
    pub fn source(&self, space: Option<&Space>) -> Result<Option<Source>, Failure> {
        let shape = |p: &&Parameter| is_shape(&p.key);
        let shaped = space.and_then(|space| space.parameters().iter().find(shape));
        match (self.kind, shaped) {
            (Some(FingerModelKind::Paper), Some(Parameter { key, .. })) => {
                Err(Failure::usage(format!(
                    "the space sets {key}, which --finger-model computed knows, paper does not"
                )))
            }
            (Some(kind), _) => self.of(kind),
            (None, Some(_)) => self.of(FingerModelKind::Computed),
            (None, None) => self.of(FingerModelKind::Paper),
        }
    }

    fn of(&self, kind: FingerModelKind) -> Result<Option<Source>, Failure> {
        match kind {
            FingerModelKind::Paper if self.finger != DEFAULT_FINGER => {
                Err(Failure::usage("--finger goes with --finger-model computed"))
            }
            FingerModelKind::Paper => Ok(None),
            FingerModelKind::Computed => find("finger", FINGERS, &self.finger).map(Some),
        }
    }
}

/// The fingers that a finger file makes; without one, the paper's.
pub fn fingers(source: Option<&Source>) -> Result<FingerSource, Failure> {
    Ok(Fingers::parse(source.cloned())?.made())
}

/// A finger file, read once: of fingers that are computed.
struct Fingers {
    source: Option<Source>,
    file: Option<FingerFile>,
}

impl Fingers {
    fn parse(source: Option<Source>) -> Result<Self, Failure> {
        let parse = |Source { file, text }: &Source| FingerFile::parse(text, file);
        let file = source.as_ref().map(parse).transpose().map_err(Failure::input)?;
        Ok(Fingers { source, file })
    }

    /// The finger whose stiffness was measured: of the file; without one, the shipped finger.
    fn measured_finger(&self) -> Result<PrintedFinger, Failure> {
        match &self.file {
            Some(file) => Ok(file.finger().clone()),
            None => printed_finger(DEFAULT_FINGER),
        }
    }

    /// What makes fingers of a design.
    fn made(self) -> FingerSource {
        match self.file {
            None => FingerSource::Paper,
            Some(file) => FingerSource::Computed(Box::new(ComputedFingers::new(file, TOUCHING))),
        }
    }
}

/// Everything that is needed to measure a design.
pub struct Setup {
    /// Measures designs.
    pub evaluator: Evaluator,
    pub space: Space,
    /// The errors under which designs are measured, if they are.
    pub uncertainty: Option<Uncertainty>,
    /// What was measured on the bench, if a study asks for its fingers there.
    pub measured: Option<Measured>,
    /// The texts all this was read from.
    pub inputs: Inputs,
}

/// Roles of the input files beside the tasks and the errors.
const SPACE: &str = "space";
const ROBOT: &str = "robot";
const STIFFNESS_DATA: &str = "stiffness";
const UNCERTAINTY: &str = "uncertainty";

/// The role of a task, counted from 1.
fn task_role(number: usize) -> String {
    format!("task_{number}")
}

impl Setup {
    /// Reads and checks the files the arguments name.
    pub fn from_arguments(arguments: &SetupArguments) -> Result<Self, Failure> {
        let names = arguments.task.split(',').map(str::trim);
        let tasks = match arguments.given.as_slice() {
            [] => names.map(|name| find("task", TASKS, name)).collect::<Result<Vec<_>, _>>()?,
            given => given.to_vec(),
        };
        let tasks: Vec<Source> = match arguments.start {
            None => tasks,
            Some(rule) => tasks.into_iter().map(|task| started(task, rule)).collect(),
        };
        let space = find("space", SPACES, &arguments.space)?;
        let robot = find("robot", ROBOTS, &arguments.robot)?;
        let parsed = Space::parse(&space.text, &space.file).map_err(Failure::input)?;
        let finger = arguments.finger_model.source(Some(&parsed))?;
        let fingers = Fingers::parse(finger)?;
        let stiffness =
            stiffness_data(arguments.stiffness_data.as_deref(), &fingers.measured_finger()?)?;
        Setup::new(&tasks, (&space, parsed), [&robot, &stiffness], fingers, arguments.engine)
    }

    /// The same from the copies kept in a study's folder.
    pub fn from_inputs(inputs: &Inputs, engine: &str) -> Result<Self, Failure> {
        let engine = EngineKind::from_name(engine)
            .ok_or_else(|| Failure::usage(format!("study.toml: no engine is called `{engine}`")))?;
        let roles = (1..).map(task_role).take_while(|role| inputs.contains_key(role));
        let tasks = roles.map(|role| input(inputs, &role)).collect::<Result<Vec<_>, _>>()?;
        let [space, robot, stiffness] =
            [SPACE, ROBOT, STIFFNESS_DATA].map(|role| input(inputs, role));
        let space = space?;
        let parsed = Space::parse(&space.text, &space.file).map_err(Failure::input)?;
        let fingers = Fingers::parse(finger_input(inputs)?)?;
        let others = [&robot?, &stiffness?];
        let mut setup = Setup::new(&tasks, (&space, parsed), others, fingers, engine)?;
        if inputs.contains_key(UNCERTAINTY) {
            setup = setup.under(input(inputs, UNCERTAINTY)?)?;
        }
        let [measurements, priors] = BENCH_ROLES;
        match inputs.contains_key(measurements) {
            true => setup.with_measurements(input(inputs, measurements)?, input(inputs, priors)?),
            false => Ok(setup),
        }
    }

    fn new(
        tasks: &[Source],
        (space_source, space): (&Source, Space),
        others: [&Source; 2],
        fingers: Fingers,
        engine: EngineKind,
    ) -> Result<Self, Failure> {
        let [robot_source, stiffness_source] = others;
        let robot = Robot::parse(&robot_source.text, &robot_source.file).map_err(Failure::input)?;
        let template =
            |task: &Source| Template::parse(&task.text, &task.file).map_err(Failure::input);
        let templates = tasks.iter().map(template).collect::<Result<Vec<_>, Failure>>()?;
        different(&templates)?;
        let roles = (1..).map(task_role).zip(tasks);
        let others = [SPACE, ROBOT, STIFFNESS_DATA].map(str::to_owned).into_iter();
        let others = others.zip([space_source, robot_source, stiffness_source]);
        let finger = fingers.source.iter().map(|source| (FINGER.to_owned(), source));
        let sources = roles.chain(others).chain(finger);
        let inputs = sources.map(|(role, source)| (role, source.text.clone())).collect();
        let surrogate = Arc::new(surrogate(stiffness_source, &fingers.measured_finger()?)?);
        let evaluator = Evaluator { surrogate, fingers: fingers.made(), templates, robot, engine };
        fit_together(&evaluator, &space, &space_source.file)?;
        Ok(Setup { inputs, evaluator, uncertainty: None, measured: None, space })
    }

    /// The evaluator with springs computed from the ribs of the shipped finger, if its own are the
    /// paper's and the design space, the tasks and the engine have a place for others.
    pub fn by_ribs(&self) -> Option<Evaluator> {
        let own = &self.evaluator;
        if own.fingers.kind() != FingerModelKind::Paper {
            return None;
        }
        let source = find("finger", FINGERS, DEFAULT_FINGER).ok()?;
        let evaluator = Evaluator {
            surrogate: Arc::clone(&own.surrogate),
            fingers: fingers(Some(&source)).ok()?,
            templates: own.templates.clone(),
            robot: own.robot.clone(),
            engine: own.engine,
        };
        fit_together(&evaluator, &self.space, SPACE).ok()?;
        Some(evaluator)
    }

    /// The same with errors under which designs are measured.
    pub fn under(mut self, errors: Source) -> Result<Self, Failure> {
        let uncertainty = Uncertainty::parse(&errors.text, &errors.file).map_err(Failure::input)?;
        self.uncertainty = Some(uncertainty);
        self.inputs.insert(UNCERTAINTY.to_owned(), errors.text);
        Ok(self)
    }

    /// The same with measurements of its one task from the bench.
    pub fn with_measurements(mut self, lines: Source, priors: Source) -> Result<Self, Failure> {
        let experiments = measured::lines(&lines, &self.task_names())?;
        let file = lines.file;
        if let [template] = self.evaluator.templates.as_slice() {
            measured::check(&file, &experiments, template, &self.space)?;
        }
        let [role, priors_role] = BENCH_ROLES.map(str::to_owned);
        let measured = Measured { priors: measured::priors(&priors)?, experiments, file };
        self.inputs.extend([(role, lines.text), (priors_role, priors.text)]);
        self.measured = Some(measured);
        Ok(self)
    }

    /// The names of its tasks.
    pub fn task_names(&self) -> Vec<&str> {
        self.evaluator.templates.iter().map(|template| template.task().name.as_str()).collect()
    }

    /// What a study records of all this.
    pub fn provenance(&self) -> Provenance {
        Provenance::new(self.evaluator.engine, sha256(&self.inputs))
    }

    /// The one task of a command that is not for several.
    pub fn only_task(&self) -> Result<&Template, Failure> {
        match self.evaluator.templates.as_slice() {
            [template] => Ok(template),
            _ => Err(Failure::usage("give one --task; only a study may have several")),
        }
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
}

/// Whether robot, engine, fingers and space, read from `file`, go with each task.
fn fit_together(evaluator: &Evaluator, space: &Space, file: &str) -> Result<(), Failure> {
    let Evaluator { fingers, templates, robot, engine, .. } = evaluator;
    if let FingerSource::Computed(fingers) = fingers {
        printable::check(space, file, &fingers.file).map_err(Failure::input)?;
    }
    let fits = |task: &Task| engine.rig(task, robot, &fingers.any(task), 1.0).map(|_| ());
    for template in templates {
        fits(template.task()).map_err(Failure::input)?;
        template.check(space, file, &fits).map_err(Failure::input)?;
    }
    sprung::check(evaluator, space, file).map_err(Failure::input)
}

/// A task file with this rule of its start. What is no task stays as it is, to be refused.
pub fn started(task: Source, rule: StartRule) -> Source {
    let Ok(mut table) = task.text.parse::<toml::Table>() else { return task };
    let Some(toml::Value::Table(strategy)) = table.get_mut("strategy") else { return task };
    let word = match rule {
        StartRule::Given => "given",
        StartRule::Taught => "taught",
    };
    strategy.insert("start".to_owned(), word.into());
    Source { text: table.to_string(), ..task }
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

/// The finger file kept in a study's folder, if its fingers are computed.
fn finger_input(inputs: &Inputs) -> Result<Option<Source>, Failure> {
    inputs.contains_key(FINGER).then(|| input(inputs, FINGER)).transpose()
}

/// The measurements the surrogate is fitted to: those at `path`, else those that the finger file names.
///
/// # Errors
/// If they cannot be read, or the finger file names none: those of another finger are not its own.
pub fn stiffness_data(path: Option<&str>, finger: &PrintedFinger) -> Result<Source, Failure> {
    let find = |name: &str| find("stiffness data", STIFFNESS, name);
    match (path, &finger.measured) {
        (Some(path), _) => find(path),
        (None, Some(named)) => match STIFFNESS.iter().find(|shipped| shipped.file == named) {
            Some(shipped) => find(shipped.name),
            None => {
                let beside = Path::new(&finger.file).parent().unwrap_or(Path::new(""));
                find(&beside.join(named).to_string_lossy())
            }
        },
        (None, None) => Err(Failure::usage(format!(
            "{}: no `measured` names a table of its measured fingers; give one there or by \
             --stiffness-data: one finger is enough",
            finger.file
        ))),
    }
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

/// Where trials of one task with one robot and such fingers are run, if they go together.
pub fn rig(
    engine: EngineKind,
    task: &Task,
    robot: &Robot,
    finger: &Finger,
) -> Result<Box<dyn Rig>, RigError> {
    engine.rig(task, robot, finger, 1.0)
}

/// The finger of that name, or of the file at that path.
pub fn printed_finger(name: &str) -> Result<PrintedFinger, Failure> {
    let source = find("finger", FINGERS, name)?;
    PrintedFinger::parse(&source.text, &source.file).map_err(Failure::input)
}

/// The stiffness model of a study, from the copies in its folder.
pub fn surrogate_of(inputs: &Inputs) -> Result<Model, Failure> {
    let finger = Fingers::parse(finger_input(inputs)?)?.measured_finger()?;
    surrogate(&input(inputs, STIFFNESS_DATA)?, &finger)
}

/// Fits the stiffness model to a CSV of measurements of such fingers.
pub fn surrogate(data: &Source, finger: &PrintedFinger) -> Result<Model, Failure> {
    let measurements = stiffness::parse(&data.text, &data.file).map_err(Failure::input)?;
    surrogate::fit(&measurements, finger).map_err(|error| match error {
        FitError::Measurements(error) => Failure::usage(format!("{}: {error}", data.file)),
        FitError::Finger(error) => Failure::input(error),
    })
}
