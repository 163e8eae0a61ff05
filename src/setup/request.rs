//! Options for tasks, space, robot, cell, stiffness data, engine and finger model.

use super::Setup;
use super::files::{DEFAULT_FINGER, Fingers, find, stiffness_data};
use crate::failure::Failure;
use clap::Arg;
use connector::mesh::axes::value;
use input::files::shell_word;
use input::shipped::{COMMERCIAL, FINGERS, ROBOTS, SPACES, Source, TASKS, resolve};
use insertion::finger::file::is_shape;
use insertion::task::parts_file::with_parts;
use insertion::{EngineKind, FingerModelKind, FingerSource, Priors, Space, StartRule, Variable};
use serde::Deserialize;
use std::convert::Infallible;
use std::fmt::Display;
use std::path::Path;

/// Default robot.
pub const DEFAULT_ROBOT: &str = "servo";
/// Default search space.
pub const DEFAULT_SPACE: &str = "infill";

/// Task by its name, or by the text of its file.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub enum TaskSource {
    /// Shipped task, or path of a task file.
    Named(String),
    /// Text of a task file passed by another program, and its name in messages.
    Given(Source),
}

impl TaskSource {
    /// Returns the tasks of a comma-separated list of names; the path of an existing file is a single task, even if it
    /// contains commas. Other programs pass a JSON array of names and texts after a NUL, which cannot occur on a
    /// command line.
    pub fn list(names: &str) -> Vec<Self> {
        if let Some(given) =
            names.strip_prefix('\0').and_then(|json| serde_json::from_str(json).ok())
        {
            return given;
        }
        if names.is_empty() || Path::new(names).is_file() {
            let task = (!names.is_empty()).then(|| TaskSource::Named(names.to_owned()));
            return task.into_iter().collect();
        }
        names.split(',').map(|name| TaskSource::Named(name.trim().to_owned())).collect()
    }

    /// Returns the task of a name, or the task passed by another program as in [`TaskSource::list`].
    pub fn single(name: &str) -> Self {
        let given = name.starts_with('\0').then(|| TaskSource::list(name));
        let given = given.and_then(|given| <[TaskSource; 1]>::try_from(given).ok());
        given.map_or_else(|| TaskSource::Named(name.to_owned()), |[task]| task)
    }

    /// Reads the task file, with the text of its parts file appended, without checking it.
    ///
    /// # Errors
    /// If there is no such task or file, or the parts file cannot be read or has changed.
    pub fn read(&self) -> Result<Source, Failure> {
        let source = match self {
            TaskSource::Named(name) => {
                resolve("task", &[TASKS, COMMERCIAL].concat(), name).map_err(Failure::task)?
            }
            TaskSource::Given(source) => source.clone(),
        };
        with_parts(source).map_err(Failure::task)
    }
}

/// Robot and contact engine of the trials with a task file.
#[derive(Debug, Clone, clap::Args)]
pub struct RobotRequest {
    /// Robot: see `optimize robots`, or the path of a robot file
    #[arg(id = "robot", long = "robot", value_name = "NAME", default_value = DEFAULT_ROBOT)]
    pub name: String,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    pub engine: EngineKind,
}

impl RobotRequest {
    /// Returns a command on a task file, with this robot and engine unless they are the default.
    pub fn command(&self, command: &str, file: impl Display) -> String {
        let robot = Some(&self.name).filter(|name| *name != DEFAULT_ROBOT);
        let robot = robot.map(|name| format!(" --robot {}", shell_word(name)));
        let engine = Some(self.engine).filter(|engine| *engine != EngineKind::default());
        let engine = engine.map(|engine| format!(" --engine {}", value(engine)));
        let options = [robot, engine].into_iter().flatten().collect::<String>();
        format!("optimize {command} {}{options}", shell_word(file))
    }
}

/// Options of a trial, an evaluation, a calibration and a study.
#[derive(Debug, Clone, clap::Args)]
pub struct SetupRequest {
    /// Task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file
    // clap takes a field of type `Vec` for a repeated option, but not `std::vec::Vec`: one value is the whole list.
    #[arg(long = "task", value_name = "NAME", value_parser = |names: &str| Ok::<_, Infallible>(TaskSource::list(names)))]
    pub tasks: std::vec::Vec<TaskSource>,
    /// Search space: infill, codesign, finger, or the path of a space file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_SPACE)]
    pub space: String,
    /// Robot: see `optimize robots`, or the path of a robot file [default: servo]
    #[arg(long, value_name = "NAME")]
    pub robot: Option<String>,
    /// Your own cell: robot, friction and more, as `optimize identify` writes it
    #[arg(long, value_name = "FILE.toml")]
    pub cell: Option<String>,
    /// Your own stiffness measurements in place of the shipped ones
    #[arg(long, value_name = "FILE.csv")]
    pub stiffness_data: Option<String>,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    pub engine: EngineKind,
    /// Finger model.
    #[command(flatten)]
    pub finger_model: FingerModelRequest,
    /// How the nominal start is chosen [default: as in the task file]
    #[arg(long, value_enum)]
    pub start: Option<StartRule>,
}

/// Adds to the help of the option `--task` that it may be given several.
pub(crate) fn several(tasks: Arg) -> Arg {
    let help = tasks.get_help().map(ToString::to_string).unwrap_or_default();
    tasks.help(help.replace("a task file", "a task file; several separated by commas"))
}

/// Finger model: source of the remote centre of compliance and of the stiffnesses that were not measured, for example
/// in tilting.
#[derive(Debug, Clone, clap::Args)]
pub struct FingerModelRequest {
    /// Source of a finger's remote centre and unmeasured stiffnesses [default: paper; computed for a
    /// space with parameters of the printed finger]
    #[arg(long = "finger-model", value_enum)]
    pub kind: Option<FingerModelKind>,
    /// Finger file for --finger-model computed: finray9, or the path of a file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_FINGER)]
    pub finger: String,
}

impl Default for SetupRequest {
    fn default() -> Self {
        SetupRequest {
            tasks: Vec::new(),
            space: DEFAULT_SPACE.to_owned(),
            robot: None,
            cell: None,
            stiffness_data: None,
            engine: EngineKind::default(),
            finger_model: FingerModelRequest { kind: None, finger: DEFAULT_FINGER.to_owned() },
            start: None,
        }
    }
}

impl SetupRequest {
    /// Reads and checks all input files.
    ///
    /// # Errors
    /// If one is invalid.
    pub fn setup(&self) -> Result<Setup, Failure> {
        self.setup_with(None)
    }

    /// Returns the setup, with the robot of these priors if they contain one.
    pub(crate) fn setup_with(&self, priors: Option<&Priors>) -> Result<Setup, Failure> {
        if self.tasks.is_empty() {
            return Err(Failure::usage("give --task"));
        }
        let task = |task: &TaskSource| Ok(with_start_rule(task.read()?, self.start));
        let tasks = self.tasks.iter().map(task).collect::<Result<Vec<_>, Failure>>()?;
        let space = find("space", SPACES, &self.space)?;
        let cell = self.cell.as_deref().map(cell).transpose()?;
        let robot = self.robot(priors.and_then(Priors::robot_text), cell.as_ref())?;
        let parsed = Space::parse(&space.text, &space.file)?;
        let fingers = Fingers::parse(self.finger_model.file(Some(&parsed))?)?;
        let stiffness = stiffness_data(self.stiffness_data.as_deref(), &fingers.file.finger)?;
        let setup =
            Setup::new(&tasks, (&space, parsed), [&robot, &stiffness], fingers, self.engine)?;
        match cell {
            Some((source, cell)) => setup.with_cell(source, cell),
            None => Ok(setup),
        }
    }

    /// Returns the robot file: that of the priors or the cell, else the named one.
    fn robot(
        &self,
        of_priors: Option<String>,
        cell: Option<&(Source, Priors)>,
    ) -> Result<Source, Failure> {
        let contained = |flag: &str, text| match &self.robot {
            Some(_) => {
                Err(Failure::usage(format!("{flag} contains a robot: leave out --robot or {flag}")))
            }
            None => Ok(Source { file: format!("{flag}: [robot]"), text }),
        };
        match (of_priors, cell.and_then(|(_, cell)| cell.robot_text())) {
            (Some(_), Some(_)) => Err(Failure::usage(
                "--priors and --cell both contain a robot: leave out one of them",
            )),
            (Some(text), None) => contained("--priors", text),
            (None, Some(text)) => contained("--cell", text),
            (None, None) => find("robot", ROBOTS, self.robot.as_deref().unwrap_or(DEFAULT_ROBOT)),
        }
    }
}

impl FingerModelRequest {
    /// Returns the finger model of a command without a search space.
    ///
    /// # Errors
    /// If the finger file is invalid.
    pub fn fingers(&self) -> Result<FingerSource, Failure> {
        Ok(Fingers::parse(self.file(None)?)?.finger_source())
    }

    /// Returns the finger file; `None` for the model of the paper. A space with shape parameters of the printed finger
    /// requires computed fingers.
    fn file(&self, space: Option<&Space>) -> Result<Option<Source>, Failure> {
        let shape = |p: &&Variable| is_shape(&p.key);
        match (self.kind, space.and_then(|space| space.parameters.iter().find(shape))) {
            (Some(FingerModelKind::Paper), Some(Variable { key, .. })) => Err(Failure::usage(
                format!("the space sets {key}, which needs --finger-model computed"),
            )),
            (Some(FingerModelKind::Computed), _) | (None, Some(_)) => {
                find("finger", FINGERS, &self.finger).map(Some)
            }
            (_, None) if self.finger != DEFAULT_FINGER => {
                Err(Failure::usage("--finger needs --finger-model computed"))
            }
            (_, None) => Ok(None),
        }
    }
}

/// Reads a cell file: robot, friction and other parameters of an installation.
fn cell(path: &str) -> Result<(Source, Priors), Failure> {
    let source = Source::read("cell", Path::new(path)).map_err(Failure::input)?;
    let cell = super::cell(&source)?;
    Ok((source, cell))
}

/// Sets the rule for the nominal start in a task file, if one is given. Passes invalid input through; the parser
/// reports it.
fn with_start_rule(task: Source, rule: Option<StartRule>) -> Source {
    let Some(rule) = rule else { return task };
    let Ok(mut table) = task.text.parse::<toml::Table>() else { return task };
    let Some(toml::Value::Table(strategy)) = table.get_mut("strategy") else { return task };
    strategy.insert("start".to_owned(), value(rule).into());
    Source { text: table.to_string(), ..task }
}
