//! Files of bench measurements and priors.

use super::Setup;
use super::files::find;
use super::request::TaskSource;
use super::task::read_task;
use crate::failure::Failure;
use crate::project::Project;
use calibration::experiments::{self, Experiment};
use calibration::subject::completed;
use input::shipped::{COMMERCIAL, MEASUREMENTS, Source, TASKS};
use insertion::{Priors, Space, Template};
use std::path::{Path, PathBuf};
use study::{BENCH_ROLES, StudyRecord};

/// Measurement file that `measure add` writes and `measure check` reads by default.
pub const BENCH_FILE: &str = "bench.csv";

/// Measurement file of a command that is about it, which therefore also takes it without an option.
#[derive(Debug, Clone, clap::Args)]
pub struct BenchFileRequest {
    /// The file
    #[arg(value_name = "FILE", default_value = BENCH_FILE)]
    file: String,
    /// The file, by the option of other commands
    #[arg(long, hide = true, value_name = "FILE", conflicts_with = "file")]
    measurements: Option<String>,
}

impl BenchFileRequest {
    /// Returns the name of the file.
    pub fn name(&self) -> &str {
        self.measurements.as_ref().unwrap_or(&self.file)
    }
}

/// Bench measurements, and priors of the parameters that were not measured.
pub struct Measured {
    /// Name of the measurement file.
    pub file: String,
    /// Measurements.
    pub experiments: Vec<Experiment>,
    /// Priors.
    pub priors: Priors,
}

/// Reads and checks the measurements of that name or at that path; their tasks are shipped ones, those in
/// `more`, or have a comment line with the path of their file.
pub fn read(name: &str, more: &[&str]) -> Result<Vec<Experiment>, Failure> {
    let source = file(name)?;
    let named = experiments::own_tasks(&source.text).into_keys();
    for task in named.filter(|task| !more.contains(task)) {
        own_task(&source, task)?;
    }
    lines(&source, more)
}

/// Reads a measurement file by its path or its shipped name.
pub fn file(name: &str) -> Result<Source, Failure> {
    if Path::new(name).is_file() {
        return Source::read("measurement file", Path::new(name)).map_err(Failure::input);
    }
    find("measurement file", MEASUREMENTS, name)
}

/// Returns whether this is the default measurement file, or the path of the project's, and does not exist yet.
pub fn is_missing(name: &str) -> bool {
    let project = || Project::current().ok().flatten()?.settings.measurements;
    let default = name == BENCH_FILE || project().as_deref() == Some(name) && name.contains('.');
    default && Path::new(name).try_exists().is_ok_and(|there| !there)
}

/// Returns the path of the user's task file from its comment line; `None` without one.
fn own_task(source: &Source, task: &str) -> Result<Option<PathBuf>, Failure> {
    let Source { file, text } = source;
    let Some(path) = experiments::own_tasks(text).remove(task) else { return Ok(None) };
    let path = Path::new(file).parent().unwrap_or(Path::new("")).join(path);
    let wrong = |problem: String| {
        let task = format!("task `{task}`: {problem}; correct the line `# task {task}: ..`");
        Failure::in_file(file, format!("{task}, or give --task"))
    };
    let found = read_task(&path.to_string_lossy()).map_err(|error| wrong(error.to_string()))?;
    match found.task.name == task {
        true => Ok(Some(path)),
        false => Err(wrong(format!("{} is called `{}`", path.display(), found.task.name))),
    }
}

/// Returns the only task of a measurement file: its own task file, named in a comment line, or a shipped one.
///
/// # Errors
/// If there are several tasks, or the file of the task is unknown.
pub fn task(source: &Source) -> Result<TaskSource, Failure> {
    let Source { file, text } = source;
    let wrong = |problem: String| Failure::in_file(file, format!("{problem}; give --task"));
    let found = experiments::parse(text, file).map_err(Failure::input)?;
    let mut tasks: Vec<&str> = found.iter().map(|line| &*line.task).collect();
    tasks.sort_unstable();
    tasks.dedup();
    let [task] = tasks[..] else {
        return Err(wrong(match tasks.is_empty() {
            true => "has no measurements yet, so that its task is unknown".to_owned(),
            false => format!("has lines of {}", tasks.join(", ")),
        }));
    };
    let shipped = || {
        [TASKS, COMMERCIAL].concat().iter().any(|shipped| shipped.name == task).then(|| task.into())
    };
    let path = own_task(source, task)?.or_else(shipped);
    let path = path.ok_or_else(|| wrong(format!("the file of the task `{task}` is unknown")))?;
    Ok(TaskSource::Named(path.to_string_lossy().into_owned()))
}

/// Largest number of fingers of a task; sampling a Gaussian process of so many takes a minute.
const MAX_FINGERS: usize = 200;

/// Reads the measurements of a file and sorts them, since their order determines the random draws. Their tasks are
/// shipped ones, those in `more`, or have a comment line with the path of their file.
pub fn lines(source: &Source, more: &[&str]) -> Result<Vec<Experiment>, Failure> {
    let shipped = TASKS.iter().chain(COMMERCIAL).map(|task| task.name);
    let own = experiments::own_tasks(&source.text).into_keys().filter(|own| !more.contains(own));
    let known: Vec<&str> = shipped.chain(more.iter().copied()).chain(own).collect();
    let found = experiments::parse_known(&source.text, &source.file, &known);
    let mut found = found.map_err(Failure::input)?;
    found.sort_by(Experiment::order);
    for of_task in found.chunk_by(|a, b| a.task == b.task) {
        let fingers = of_task.chunk_by(|a, b| a.design == b.design).count();
        if fingers > MAX_FINGERS {
            let (file, task) = (&source.file, &of_task[0].task);
            let problem = format!(
                "has {fingers} different fingers of the task `{task}`; at most {MAX_FINGERS} are \
                 accepted: keep those nearest to the best"
            );
            return Err(Failure::in_file(file, problem));
        }
    }
    Ok(found)
}

/// Checks that at least one range of the task was measured and that all measured fingers lie in the space.
pub fn check(
    file: &str,
    lines: &[Experiment],
    template: &Template,
    space: &Space,
) -> Result<(), Failure> {
    let task = &template.task.name;
    let own = || lines.iter().filter(|line| line.task == *task);
    if !own().any(|line| line.extent().is_some()) {
        let problem = format!(
            "no line has a range of the task `{task}`; measure one finger at least (`optimize next` \
             recommends one), or leave out --measurements"
        );
        return Err(Failure::in_file(file, problem));
    }
    for line in own() {
        completed(space, template, line).map_err(|error| Failure::in_file(file, error))?;
    }
    Ok(())
}

/// Returns the number of new measurements of the tasks of the study in `dir`; `None` if anything else
/// differs from this setup. New measurements change no simulated value.
pub fn new_measurements(dir: &Path, setup: &Setup) -> Option<usize> {
    let text = setup.inputs.get(BENCH_ROLES[0])?;
    let record = StudyRecord::load(dir).ok()?;
    let (mut before, mut now) = (record.segments.last()?.provenance.clone(), setup.provenance());
    let inputs = record.inputs(dir).ok()?;
    let known = inputs.get(BENCH_ROLES[0]);
    // A study without measurements has no priors either.
    for role in BENCH_ROLES.iter().take(if known.is_some() { 1 } else { 2 }) {
        before.input_sha256.remove(*role);
        now.input_sha256.remove(*role);
    }
    let lines = |text: &str| {
        let mut lines = experiments::parse(text, "").ok()?;
        // New comments may have changed the line numbers.
        lines.iter_mut().for_each(|line| line.line = 0);
        Some(lines)
    };
    let (known, found) = (lines(known.map_or("", String::as_str))?, lines(text)?);
    let new = found.strip_prefix(&known[..]).filter(|new| !new.is_empty() && now == before)?;
    let tasks = setup.task_names();
    Some(new.iter().filter(|line| tasks.contains(&&*line.task)).count())
}
