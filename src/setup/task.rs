//! Task and space files, and checks of a task.

use super::files::{find, robot};
use super::request::{RobotRequest, TaskSource};
use super::tune::{self, tune_until_success};
use crate::layout::lines;
use crate::{Context, Failure, not_stopped};
use connector::check::{Problem, problems};
use connector::nominal;
use connector::tune::{Stage, Tuned};
use input::Place;
use input::shipped::{SPACES, Source};
use input::units::N_PER_MM;
use insertion::stiffness::representative_designs;
use insertion::{EngineKind, Finger, Grasp, Outcome, Recording, Robot, Space, Task, Trial};
use report::answer::words::mating_force;
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// Task file: its text and the task.
#[derive(Debug, Clone)]
pub struct TaskFile {
    /// Text of the file, and its name in messages.
    pub source: Source,
    /// The task.
    pub task: Task,
}

impl TaskFile {
    /// Checks the text of a task file.
    pub fn parse(source: Source) -> Result<Self, Failure> {
        let task = Task::parse(&source.text, &source.file).map_err(Failure::task)?;
        Ok(TaskFile { source, task })
    }

    /// Checks a task file and returns its fields.
    pub fn fields(source: Source) -> Result<toml::Table, Failure> {
        let Source { file, text } = TaskFile::parse(source)?.source;
        input::read(&text, &file).map_err(Failure::input)
    }

    /// Creates a task file with these fields and checks it; `file` is its name in messages.
    pub fn of_fields(file: &str, fields: &serde_json::Value) -> Result<Self, Failure> {
        let unfit =
            |error: toml::ser::Error| Failure::task(Place::file(file).fault(error.to_string()));
        // Names the key of a wrong value; the parser below would quote a line that the caller has not written.
        let table = toml::Table::try_from(fields).map_err(unfit)?;
        Task::from_table(table, file).map_err(Failure::task)?;
        let text = toml::to_string(fields).map_err(unfit)?;
        TaskFile::parse(Source { file: file.to_owned(), text })
    }
}

/// Reads the task of that name, or of the file at that path.
pub fn read_task(name: &str) -> Result<TaskFile, Failure> {
    TaskFile::parse(TaskSource::Named(name.to_owned()).read()?)
}

/// Reads the space of that name, or of the file at that path.
pub fn read_space(name: &str) -> Result<Space, Failure> {
    let source = find("space", SPACES, name)?;
    Space::parse(&source.text, &source.file).map_err(Failure::input)
}

/// Check of a task file: its problems, and the trial at its nominal start.
pub struct TaskCheck {
    /// The file.
    pub source: Source,
    /// The task, if the file is valid.
    pub task: Option<Task>,
    /// Problems.
    pub problems: Vec<Problem>,
    /// Finger, trial and explanation of the nominal start; `None` if there are problems.
    pub nominal: Option<(Finger, Trial, String)>,
    /// Warnings about the nominal start.
    pub warnings: Vec<String>,
    /// Robot and engine of the trial.
    with: RobotRequest,
}

impl TaskCheck {
    /// Checks a task file with this robot.
    ///
    /// # Errors
    /// If the nominal start cannot be simulated; if `stop` is set meanwhile.
    pub fn of(source: Source, with: &RobotRequest, stop: &AtomicBool) -> Result<Self, Failure> {
        let with = with.clone();
        let task = match Task::parse(&source.text, &source.file) {
            Ok(task) => task,
            Err(error) => {
                let problems = Problem::of_file(&error);
                let (nominal, warnings) = (None, Vec::new());
                return Ok(TaskCheck { source, task: None, problems, nominal, warnings, with });
            }
        };
        let problems = problems(&task);
        let (mut nominal, mut warnings) = (None, Vec::new());
        if problems.is_empty() {
            let robot = robot(&with.name)?;
            let (finger, trial) = nominal_start(&task, &robot, with.engine, stop)?;
            warnings = nominal_warnings(&task, &trial, &robot);
            let explanation = nominal::explain(&task, &trial);
            nominal = Some((finger, trial, explanation));
        }
        Ok(TaskCheck { source, task: Some(task), problems, nominal, warnings, with })
    }

    /// Tunes a task whose nominal start fails; `None` if it inserts, or if there are problems.
    ///
    /// # Errors
    /// If the task cannot be simulated; if `stop` is set meanwhile.
    pub fn tune(&self, stop: &AtomicBool) -> Result<Option<Tuned>, Failure> {
        match (&self.task, &self.nominal) {
            (Some(task), Some((_, trial, _))) if trial.outcome != Outcome::Inserted => {
                tune_until_success(task, &self.with, Stage::Search, stop).map(Some)
            }
            _ => Ok(None),
        }
    }
}

/// Returns the outcome of a trial as JSON.
pub(crate) fn outcome_json(trial: &Trial) -> Value {
    json!({
        "outcome": trial.outcome.word(),
        "failure": trial.outcome.failure(),
        "robot_stopped": trial.robot_stopped,
        "depth_mm": trial.depth_mm,
        "tilt_deg": trial.tilt_deg,
        "peak_force_n": trial.peak_force_n,
        "slip_mm": trial.slip_mm,
    })
}

/// Returns the measured finger of medium stiffness and its trial at the nominal start.
pub(crate) fn nominal_start(
    task: &Task,
    robot: &Robot,
    engine: EngineKind,
    stop: &AtomicBool,
) -> Result<(Finger, Trial), Failure> {
    let (finger, shaped) = medium(task);
    let rig = engine.rig(task, robot, &shaped, 1.0)?;
    let trial = rig.grasp(Grasp { stop, ..Grasp::of(&shaped) }).trial(0.0);
    not_stopped(stop)?;
    Ok((finger, trial))
}

/// Returns warnings about a trial of [`nominal_start`]: a weak grip, a robot stop although the plug is seated, and a force
/// that the connector does not withstand.
pub(crate) fn nominal_warnings(task: &Task, trial: &Trial, robot: &Robot) -> Vec<String> {
    let stops = trial.outcome == Outcome::Inserted && trial.robot_stopped;
    let stops = stops.then(|| {
        let robot = &robot.name;
        format!(
            "the plug is seated, but the robot {robot} stops; `optimize evaluate` computes the longest push without a stop"
        )
    });
    let peak_n = trial.peak_force_n;
    let exceeded = task.limits.force.filter(|limit| peak_n > *limit).map(|limit| {
        format!("the peak force, {peak_n:.1} N, exceeds the {limit} N that the connector withstands (limits.force_n)")
    });
    nominal::weak_grip(task, trial).into_iter().chain(stops).chain(exceeded).collect()
}

/// Shows a warning of a weak grip in the trial of [`nominal_start`].
pub(crate) fn warn_of_weak_grip(
    task: &Task,
    robot: &Robot,
    engine: EngineKind,
    context: &Context<'_>,
) -> Result<(), Failure> {
    let (_, trial) = nominal_start(task, robot, engine, context.stop)?;
    let text = nominal::weak_grip(task, &trial);
    text.iter().for_each(|text| context.note(&format!("warning: {text}")));
    Ok(())
}

/// Returns the measured finger of medium stiffness, with the finger model of the task, and the recording of its trial
/// at the nominal start.
pub(crate) fn nominal_recording(
    task: &Task,
    robot: &Robot,
    stop: &AtomicBool,
) -> Result<(Finger, Recording), Failure> {
    let (_, shaped) = medium(task);
    let rig = EngineKind::default().rig(task, robot, &shaped, 1.0)?;
    let recording = rig.record(Grasp { stop, ..Grasp::of(&shaped) }, 0.0);
    not_stopped(stop)?;
    Ok((shaped, recording.ok_or_else(|| Failure::running("the engine records no trials"))?))
}

/// Returns the shipped measured finger of medium stiffness, and the same finger with the finger model of a task.
fn medium(task: &Task) -> (Finger, Finger) {
    // The index is valid, since the shipped table is not empty.
    let middle = representative_designs()[1];
    let finger = Finger::new(middle.compliance, middle.assembly);
    (finger, finger.with_model(&task.finger, 0.0))
}

impl TaskCheck {
    /// Returns the problems and the nominal start as JSON.
    pub fn json(&self) -> Value {
        let nominal = self.nominal.as_ref().map(|(finger, trial, explanation)| {
            let mut json = outcome_json(trial);
            json["compliance_n_per_mm"] = json!(finger.compliance / N_PER_MM);
            json["assembly_n_per_mm"] = json!(finger.assembly / N_PER_MM);
            json["explanation"] = json!(explanation);
            json
        });
        let (problems, warnings) = (&self.problems, &self.warnings);
        let valid = problems.is_empty();
        json!({"valid": valid, "problems": problems, "nominal": nominal, "warnings": warnings})
    }

    /// Returns a line for each problem and one for the nominal start.
    pub fn text(&self) -> String {
        let about = self.task.iter().map(|task| ("task".to_owned(), task.description.clone()));
        let mut text = lines(about);
        for Problem { key, problem, remedy } in &self.problems {
            text.push_str(&format!(
                "problem       {key}\n              {problem}\n              right: {remedy}\n"
            ));
        }
        match &self.nominal {
            None => text.push_str("nominal       not tried: fix the problems first\n"),
            Some((finger, trial, explanation)) => text.push_str(&format!(
                "geometry      no problems\n\
                 robot         {}\n\
                 finger        compliance {} N/mm, assembly {} N/mm: the medium one of the measured fingers\n\
                 mating force  {}\n\
                 nominal       {}, in this trial peak force {:.1} N, slip {:.2} mm\n              {explanation}\n",
                self.with.name,
                finger.compliance / N_PER_MM,
                finger.assembly / N_PER_MM,
                mating_force(self.task.as_ref().and_then(Task::largest_mating_force)),
                trial.outcome.label(),
                trial.peak_force_n,
                trial.slip_mm,
            )),
        }
        let warnings = self.warnings.iter().map(|text| ("warning".to_owned(), text.clone()));
        text + &lines(warnings)
    }

    /// Returns the command that tunes the task with the same robot.
    pub fn tune_command(&self) -> String {
        self.with.command("task tune", &self.source.file)
    }

    /// Returns the text for a new task, with the next command if the nominal start inserts.
    pub fn text_of_new(&self) -> String {
        let next = match self.failure() {
            None => format!("next          {}\n", self.tune_command()),
            Some(_) => String::new(),
        };
        self.text() + &next
    }

    /// Returns the error if there are problems or the nominal start does not insert, with the number of problems.
    pub fn failure(&self) -> Option<Failure> {
        let file = &self.source.file;
        let outcome = self.nominal.as_ref().map(|(_, trial, _)| trial.outcome);
        let failed = || match self.problems.len() {
            0 => format!("{file}: the nominal start does not insert"),
            1 => format!("{file}: 1 problem"),
            count => format!("{file}: {count} problems"),
        };
        (outcome != Some(Outcome::Inserted)).then(|| Failure::usage(failed()))
    }

    /// Returns the error if the nominal start of a new task does not insert.
    pub fn failure_of_new(&self, tuned: Option<&Tuned>) -> Option<Failure> {
        let (failure, file) = (self.failure()?, &self.source.file);
        Some(Failure::running(tuned.map_or(failure.to_string(), |tuned| {
            let (tried, command) = (tune::tried(tuned), self.tune_command());
            format!("{file}: does not insert; tried: {tried}; `{command}` tries more")
        })))
    }
}
