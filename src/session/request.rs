//! Which tasks, space, robot and finger model: names on the way to files.

use super::files::{Fingers, find, stiffness_data};
use super::{Failure, Setup};
use input::shipped::{FINGERS, ROBOTS, SPACES, Source, TASKS};
use insertion::finger::file::is_shape;
use insertion::finger::model::{FingerModelKind, FingerSource};
use insertion::space::{Parameter, Space};
use insertion::task::StartRule;
use insertion::trial::engine::EngineKind;
use std::convert::Infallible;
use std::path::Path;

/// Robot used unless another is named.
pub const DEFAULT_ROBOT: &str = "servo";
/// Finger file used unless another is named.
pub const DEFAULT_FINGER: &str = "finray9";
/// Search space used unless another is named.
pub const DEFAULT_SPACE: &str = "infill";

/// A task by its name, or by the text of its file.
#[derive(Debug, Clone)]
pub enum TaskSource {
    /// A shipped task, or the path of a task file.
    Named(String),
    /// The text of a task file, and what messages call it.
    Given(Source),
}

impl TaskSource {
    /// The tasks of a list of names by commas, or the one file whose path has commas.
    pub fn list(names: &str) -> Vec<Self> {
        if names.is_empty() || Path::new(names).is_file() {
            let one = (!names.is_empty()).then(|| TaskSource::Named(names.to_owned()));
            return one.into_iter().collect();
        }
        names.split(',').map(|name| TaskSource::Named(name.trim().to_owned())).collect()
    }

    /// Its file, unchecked.
    pub fn read(&self) -> Result<Source, Failure> {
        match self {
            TaskSource::Named(name) => find("task", TASKS, name),
            TaskSource::Given(source) => Ok(source.clone()),
        }
    }
}

/// What a trial, an evaluation, a calibration and a study have in common.
#[derive(Debug, Clone, clap::Args)]
pub struct SetupRequest {
    /// Task: ket8, ket12, rj45, usb, or the path of a task file; a study may have several, by commas
    // By its full path the whole list is one value of the option.
    #[arg(long = "task", value_name = "NAME", value_parser = |names: &str| Ok::<_, Infallible>(TaskSource::list(names)))]
    pub tasks: std::vec::Vec<TaskSource>,
    /// Search space: infill, codesign, finger, or the path of a space file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_SPACE)]
    pub space: String,
    /// Robot: see `optimize robots`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    pub robot: String,
    /// Your own stiffness measurements in place of the shipped ones
    #[arg(long, value_name = "FILE.csv")]
    pub stiffness_data: Option<String>,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    pub engine: EngineKind,
    /// Where the springs of a finger come from that were not measured.
    #[command(flatten)]
    pub finger_model: FingerModelRequest,
    /// What becomes of the nominal start, in place of what the task file says
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
            robot: DEFAULT_ROBOT.to_owned(),
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
        let robot = find("robot", ROBOTS, &self.robot)?;
        let parsed = Space::parse(&space.text, &space.file).map_err(Failure::input)?;
        let fingers = Fingers::parse(self.finger_model.file(Some(&parsed))?)?;
        let stiffness =
            stiffness_data(self.stiffness_data.as_deref(), &fingers.measured_finger()?)?;
        Setup::new(&tasks, (&space, parsed), [&robot, &stiffness], fingers, self.engine)
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
        let shape = |p: &&Parameter| is_shape(&p.key);
        let shaped = space.and_then(|space| space.parameters.iter().find(shape));
        let kind = match (self.kind, shaped) {
            (Some(FingerModelKind::Paper), Some(Parameter { key, .. })) => {
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
