//! Commands suggested with an answer: the next step, and how to run the study again.

use super::trust::Trust;
use super::{Answer, Verdict};
use input::files::shell_word;
use input::shipped::{
    FINGERS, MEASUREMENTS, ROBOTS, SPACES, STIFFNESS, Shipped, TASKS, UNCERTAINTIES,
};
use insertion::evaluation::INDIFFERENCE_MM;
use insertion::trial::engine::EngineKind;
use insertion::{DENSITY_KEY, DIRECTION_KEY};
use std::path::Path;
use study::{CELL, FINGER, StudyRecord, input_path, sha256_hex};

/// Inputs of a study as command arguments: shipped ones by name, others by their copies in `dir`. The role of an input
/// is its key in the provenance: `task_1`, `robot`.
struct InputArguments<'a> {
    record: &'a StudyRecord,
    dir: &'a Path,
}

impl InputArguments<'_> {
    /// Returns the name of the shipped file that is identical to an input.
    fn shipped(&self, role: &str, shipped: &[Shipped]) -> Option<&'static str> {
        let hash = self.record.provenance().input_sha256.get(role)?;
        let same = |file: &&Shipped| sha256_hex(file.text.as_bytes()) == *hash;
        shipped.iter().find(same).map(|file| file.name)
    }

    fn input(&self, role: &str, shipped: &[Shipped]) -> String {
        let segment = self.record.segments.len().max(1);
        match self.shipped(role, shipped) {
            Some(name) => name.to_owned(),
            None => shell_word(input_path(self.dir, segment, role).display()),
        }
    }

    /// Returns the user's own file of the task at `place`; `None` if it was passed as text from Python.
    fn own_file(&self, place: usize) -> Option<String> {
        let own = self.shipped(&format!("task_{}", place + 1), TASKS).is_none();
        let files = &self.record.config.conclusion.task_files;
        files.get(place).filter(|file| own && file.ends_with(".toml")).map(shell_word)
    }

    /// Returns the measurements of the study: a shipped name, the user's file, or its copy.
    fn measurements(&self) -> String {
        let shipped = self.shipped("measurements", MEASUREMENTS).map(str::to_owned);
        let own = || self.record.config.conclusion.measurements.as_ref().map(shell_word);
        shipped.or_else(own).unwrap_or_else(|| self.input("measurements", MEASUREMENTS))
    }

    /// Returns the options of [`Self::changed_setup`] with the user's own robot file in place of its copy.
    fn own_setup(&self) -> Vec<String> {
        let own = &self.record.config.conclusion.robot_file;
        let copy = self.input("robot", ROBOTS);
        let own = if own.ends_with(".toml") { shell_word(own) } else { copy.clone() };
        self.changed_setup().into_iter().map(|word| word.replace(&copy, &own)).collect()
    }

    /// Returns the options from the space to the engine that are not the defaults.
    fn changed_setup(&self) -> Vec<String> {
        setup(self).into_iter().filter(|word| !DEFAULTS.contains(&word.as_str())).collect()
    }
}

/// Number of fingers to print at a time.
const PRINTS: usize = 3;

/// Returns the next step as a complete command, and its purpose; `dir` is the study's folder.
pub fn next(answer: &Answer, dir: &Path) -> (String, &'static str) {
    let folder = shell_word(dir.display());
    if answer.record.unfinished() {
        return (format!("optimize resume {folder}"), "continue the unfinished study");
    }
    let inputs = InputArguments { record: answer.record, dir };
    let several = answer.record.config.several_tasks();
    // Measurements refer to the name of the user's file, not to that of its copy.
    let task = inputs.own_file(0).unwrap_or_else(|| inputs.input("task_1", TASKS));
    if let Some(command) = evaluate(answer, &inputs) {
        return (command, "compute a push with which the robot does not stop");
    }
    match (&answer.verdict, &answer.trust) {
        (Verdict::NothingInserts { place, .. }, _) => repair(answer.record, dir, *place),
        (Verdict::NoneFeasible, _) => (
            format!("optimize report {folder}"),
            "see by how much each design violates the constraints",
        ),
        _ if several => {
            ("optimize measure add bench.csv".to_owned(), "enter the measurements of your robot")
        }
        (verdict, trust) => {
            let mut setup = inputs.own_setup();
            let file = match trust {
                Trust::Calibrated { .. } => inputs.measurements(),
                Trust::Published { .. } => MEASUREMENTS[0].name.to_owned(),
                Trust::Simulated { .. } => "bench.csv".to_owned(),
            };
            let why = match (verdict, trust) {
                (Verdict::MeasuredBefore(_), _) => "check whether another print is worth it",
                (_, Trust::Calibrated { .. }) => "choose the prints with the largest expected gain",
                (_, Trust::Published { .. }) => "choose the first prints from measurements as well",
                (_, Trust::Simulated { .. }) => "choose prints; measure add takes their ranges",
            };
            // Another space may not contain the published fingers.
            setup.retain(|word| file != MEASUREMENTS[0].name || !word.starts_with("--space "));
            let options = format!("--task {task} --measurements {file} --count {PRINTS}");
            setup.insert(0, format!("optimize next {options}"));
            (setup.join(" "), why)
        }
    }
}

/// Returns the command that evaluates the finger on the first task on which the robot stops in most insertions; `None` if
/// there is none.
fn evaluate(answer: &Answer, inputs: &InputArguments) -> Option<String> {
    let (place, _) = answer.stopped()?;
    let task = inputs.input(&format!("task_{}", place + 1), TASKS);
    let of_finger = answer.verdict.finger()?.0.iter().map(|(key, value)| match key.as_str() {
        DENSITY_KEY => format!("--density {value}"),
        DIRECTION_KEY => format!("--direction {value}"),
        _ => format!("--set {key}={value}"),
    });
    let words = inputs.changed_setup().into_iter().chain(of_finger);
    Some(words.fold(format!("optimize evaluate --task {task}"), |all, word| all + " " + &word))
}

/// Returns the command for the task with index `place`, whose nominal start fails, and the command's purpose. It
/// changes a user's own file, but writes a new one for a task given as text.
pub fn repair(record: &StudyRecord, dir: &Path, place: usize) -> (String, &'static str) {
    let (inputs, role) = (InputArguments { record, dir }, format!("task_{}", place + 1));
    let robot = inputs.own_setup().into_iter().find(|word| word.starts_with("--robot "));
    let robot = robot.map_or(String::new(), |robot| format!(" {robot}"));
    if let Some(shipped) = inputs.shipped(&role, TASKS) {
        return (format!("optimize task check {shipped}{robot}"), "find out why nothing inserts");
    }
    let file = inputs.own_file(place).unwrap_or_else(|| {
        format!("{} --out {}.toml", inputs.input(&role, TASKS), record.config.tasks[place])
    });
    (format!("optimize task tune {file}{robot}"), "find a start and a strategy that insert")
}

/// Returns whether the first task of a study is not a shipped one.
pub fn own_task(record: &StudyRecord) -> bool {
    InputArguments { record, dir: Path::new("") }.shipped("task_1", TASKS).is_none()
}

/// Returns the command that runs a study again from its folder, one option per element.
pub fn rerun(record: &StudyRecord) -> Vec<String> {
    let config = &record.config;
    let inputs = InputArguments { record, dir: Path::new("") };
    let tasks = (1..=config.tasks.len()).map(|n| inputs.input(&format!("task_{n}"), TASKS));
    let tasks = tasks.collect::<Vec<_>>().join(",");
    let mut words = vec!["optimize".to_owned(), format!("--task {tasks}")];
    words.extend(setup(&inputs));
    words.push(format!("--optimizer {}", config.optimizer));
    words.push(format!("--objective {}", config.objective));
    words.extend(config.constraints.iter().map(|limit| format!("--constraint '{limit}'")));
    if config.uncertainty.is_some() {
        words.push(format!("--uncertainty {}", inputs.input("uncertainty", UNCERTAINTIES)));
    }
    let aggregate = config.aggregate.iter().map(|of| format!("--aggregate {of}"));
    // The configuration has the weights after `weighted`; on the command line they are an option.
    words.extend(aggregate.map(|of| of.replace("weighted ", "weighted --weights ")));
    if config.indifference_mm != INDIFFERENCE_MM {
        words.push(format!("--indifference-mm {}", config.indifference_mm));
    }
    words.push(format!("--seed {}", config.seed));
    words.extend((!config.settles).then(|| format!("--budget {}", config.budget)));
    words.extend((config.polish > 0).then(|| format!("--polish {}", config.polish)));
    words.push(format!("--batch {}", config.batch));
    words.extend(config.asynchronous.then(|| "--async".to_owned()));
    words
}

/// Returns the command for a trial of the first task, to which design and offset are appended; `dir` is the study's
/// folder.
pub fn trial(record: &StudyRecord, dir: &Path) -> String {
    let inputs = InputArguments { record, dir };
    let task = format!("optimize trial --task {}", inputs.input("task_1", TASKS));
    [vec![task], inputs.changed_setup()].concat().join(" ")
}

/// Default options of the setup.
const DEFAULTS: [&str; 3] = ["--space infill", "--robot servo", "--finger-model paper"];

/// Returns the options from the space to the engine.
fn setup(inputs: &InputArguments) -> Vec<String> {
    let provenance = inputs.record.provenance();
    // A cell includes its robot.
    let robot = match provenance.input_sha256.contains_key(CELL) {
        true => format!("--cell {}", inputs.input(CELL, &[])),
        false => format!("--robot {}", inputs.input("robot", ROBOTS)),
    };
    let mut words = vec![format!("--space {}", inputs.input("space", SPACES)), robot];
    if inputs.shipped("stiffness", STIFFNESS).is_none() {
        words.push(format!("--stiffness-data {}", inputs.input("stiffness", &[])));
    }
    words.push(format!(
        "--finger-model {}",
        insertion::value_name(inputs.record.config.finger_model)
    ));
    if provenance.input_sha256.contains_key(FINGER) {
        words.push(format!("--finger {}", inputs.input(FINGER, FINGERS)));
    }
    let engine = &provenance.engine.name;
    words.extend((*engine != EngineKind::Direct.name()).then(|| format!("--engine {engine}")));
    words
}
