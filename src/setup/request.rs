//! Which tasks, space, robot and finger model: names on the way to files.

use super::Setup;
use super::files::{DEFAULT_FINGER, Fingers, find, stiffness_data};
use crate::failure::Failure;
use input::files::{LARGEST_INPUT, read_named};
use input::shipped::{FINGERS, ROBOTS, SPACES, Source, TASKS, resolve};
use insertion::evaluation::cell::Priors;
use insertion::finger::file::is_shape;
use insertion::finger::model::{FingerModelKind, FingerSource};
use insertion::space::{Space, Variable};
use insertion::task::StartRule;
use insertion::trial::engine::EngineKind;
use serde::Deserialize;
use std::convert::Infallible;
use std::path::Path;

/// Robot used unless another is named.
pub const DEFAULT_ROBOT: &str = "servo";
/// Search space used unless another is named.
pub const DEFAULT_SPACE: &str = "infill";

/// A task by its name, or by the text of its file.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub enum TaskSource {
    /// A shipped task, or the path of a task file.
    Named(String),
    /// The text of a task file, and what messages call it.
    Given(Source),
}

impl TaskSource {
    /// Returns the tasks of a list of names by commas, or the one file whose path has commas. Other programs
    /// give names and texts as JSON behind a NUL, which no argument of a process can hold.
    pub fn list(names: &str) -> Vec<Self> {
        if let Some(given) =
            names.strip_prefix('\0').and_then(|json| serde_json::from_str(json).ok())
        {
            return given;
        }
        if names.is_empty() || Path::new(names).is_file() {
            let one = (!names.is_empty()).then(|| TaskSource::Named(names.to_owned()));
            return one.into_iter().collect();
        }
        names.split(',').map(|name| TaskSource::Named(name.trim().to_owned())).collect()
    }

    /// Returns the task of a name, or the one that another program gives.
    pub fn one(name: &str) -> Self {
        let given = name.starts_with('\0').then(|| TaskSource::list(name));
        let given = given.and_then(|given| <[TaskSource; 1]>::try_from(given).ok());
        given.map_or_else(|| TaskSource::Named(name.to_owned()), |[one]| one)
    }

    /// Reads its file, unchecked.
    ///
    /// # Errors
    /// If there is no such task or file.
    pub fn read(&self) -> Result<Source, Failure> {
        match self {
            TaskSource::Named(name) => resolve("task", TASKS, name).map_err(Failure::task),
            TaskSource::Given(source) => Ok(source.clone()),
        }
    }
}

/// Options that a trial, an evaluation, a calibration and a study share.
#[derive(Debug, Clone, clap::Args)]
pub struct SetupRequest {
    /// Task: ket8, ket12, rj45, usb, or the path of a task file; a study may have several, by commas
    // By its full path the whole list is one value of the option.
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
    /// Where the springs of a finger come from that were not measured.
    #[command(flatten)]
    pub finger_model: FingerModelRequest,
    /// How the nominal start is chosen, in place of the task file's rule
    #[arg(long, value_enum)]
    pub start: Option<StartRule>,
}

/// Where the springs of a finger come from that were not measured.
#[derive(Debug, Clone, clap::Args)]
pub struct FingerModelRequest {
    /// Where a finger's remote centre and unmeasured springs come from [default: paper; computed
    /// for a space with numbers of the printed finger]
    #[arg(long = "finger-model", value_enum)]
    pub kind: Option<FingerModelKind>,
    /// Finger file of --finger-model computed: finray9, or the path of one
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
    /// Reads and checks all that is named.
    pub fn setup(&self) -> Result<Setup, Failure> {
        self.setup_with(None)
    }

    /// The same with the robot that these priors hold, if they do.
    pub(crate) fn setup_with(&self, priors: Option<&Priors>) -> Result<Setup, Failure> {
        if self.tasks.is_empty() {
            return Err(Failure::usage("give --task"));
        }
        let task = |task: &TaskSource| {
            let source = task.read()?;
            Ok(match self.start {
                Some(rule) => started(source, rule),
                None => source,
            })
        };
        let tasks = self.tasks.iter().map(task).collect::<Result<Vec<_>, Failure>>()?;
        let space = find("space", SPACES, &self.space)?;
        let cell = self.cell.as_deref().map(cell).transpose()?;
        let robot = self.robot(priors.and_then(Priors::robot_text), cell.as_ref())?;
        let parsed = Space::parse(&space.text, &space.file).map_err(Failure::input)?;
        let fingers = Fingers::parse(self.finger_model.file(Some(&parsed))?)?;
        let stiffness = stiffness_data(self.stiffness_data.as_deref(), fingers.measured_finger())?;
        let setup =
            Setup::new(&tasks, (&space, parsed), [&robot, &stiffness], fingers, self.engine)?;
        match cell {
            Some((source, cell)) => setup.within(source, cell),
            None => Ok(setup),
        }
    }

    /// The file of the robot: of the one that priors or the cell hold, else of the one named.
    fn robot(
        &self,
        of_priors: Option<String>,
        cell: Option<&(Source, Priors)>,
    ) -> Result<Source, Failure> {
        let held = |flag: &str, text| match &self.robot {
            Some(_) => {
                Err(Failure::usage(format!("{flag} holds a robot: leave out --robot or {flag}")))
            }
            None => Ok(Source { file: format!("{flag}: [robot]"), text }),
        };
        match (of_priors, cell.and_then(|(_, cell)| cell.robot_text())) {
            (Some(_), Some(_)) => Err(Failure::usage(
                "--priors holds a robot, and so does --cell: leave out one of them",
            )),
            (Some(text), None) => held("--priors", text),
            (None, Some(text)) => held("--cell", text),
            (None, None) => find("robot", ROBOTS, self.robot.as_deref().unwrap_or(DEFAULT_ROBOT)),
        }
    }
}

impl FingerModelRequest {
    /// Source of fingers where no space is searched.
    pub fn fingers(&self) -> Result<FingerSource, Failure> {
        Ok(Fingers::parse(self.file(None)?)?.made())
    }

    /// The finger file, if fingers are computed: as those of a space with numbers of a printed
    /// finger have to be.
    fn file(&self, space: Option<&Space>) -> Result<Option<Source>, Failure> {
        let shape = |p: &&Variable| is_shape(&p.key);
        let shaped = space.and_then(|space| space.parameters.iter().find(shape));
        let kind = match (self.kind, shaped) {
            (Some(FingerModelKind::Paper), Some(Variable { key, .. })) => {
                return Err(Failure::usage(format!(
                    "the space sets {key}, which --finger-model computed knows, paper does not"
                )));
            }
            (Some(kind), _) => kind,
            (None, Some(_)) => FingerModelKind::Computed,
            (None, None) => FingerModelKind::Paper,
        };
        match kind {
            FingerModelKind::Paper if self.finger != DEFAULT_FINGER => {
                Err(Failure::usage("--finger goes with --finger-model computed"))
            }
            FingerModelKind::Paper => Ok(None),
            FingerModelKind::Computed => find("finger", FINGERS, &self.finger).map(Some),
        }
    }
}

/// The file of a cell, and what it says.
fn cell(path: &str) -> Result<(Source, Priors), Failure> {
    let text = read_named(Path::new(path), LARGEST_INPUT)
        .map_err(|error| Failure::in_file(path, format!("cannot read the cell: {error}")))?;
    let source = Source { file: path.to_owned(), text };
    let cell = super::cell(&source)?;
    Ok((source, cell))
}

/// A task file with this rule of its start. What is no task stays as it is, to be refused.
fn started(task: Source, rule: StartRule) -> Source {
    let Ok(mut table) = task.text.parse::<toml::Table>() else { return task };
    let Some(toml::Value::Table(strategy)) = table.get_mut("strategy") else { return task };
    let word = match rule {
        StartRule::Given => "given",
        StartRule::Taught => "taught",
    };
    strategy.insert("start".to_owned(), word.into());
    Source { text: table.to_string(), ..task }
}
