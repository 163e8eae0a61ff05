//! The commands as calls, for other languages: words of the command line in, what `--json`
//! prints out. Nothing is printed, and failures have the texts that the command prints.

use super::setup;
use super::{Failure, evaluate, recommended, resume, stiffness, study, summary, trial};
use crate::report;
use crate::study::{StudyRecord, evaluations_csv};
use clap::{Args, Parser};
use input::shipped::{SPACES, Source, TASKS};
use insertion::space::{Parameter, Space};
use insertion::surrogate::Prediction;
use insertion::task::Task;
use insertion::trial::Sample;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// The words of one command.
#[derive(Parser)]
#[command(no_binary_name = true)]
struct Words<T: Args> {
    #[command(flatten)]
    arguments: T,
}

/// Reads the words of a command; the text of a failure is clap's.
pub(super) fn read<T: Args>(words: &[String]) -> Result<T, Failure> {
    let read = Words::<T>::try_parse_from(words).map_err(|error| {
        let text = error.render().to_string();
        Failure::usage(text.strip_prefix("error: ").unwrap_or(&text).trim_end())
    })?;
    Ok(read.arguments)
}

/// `optimize evaluate` with these words; `tasks`, if there are any, in place of the file that
/// `--task` names. Ends early, with a failure, once `stop` is set.
///
/// # Errors
/// As the command fails.
pub fn evaluate(words: &[String], tasks: &[Source], stop: &AtomicBool) -> Result<Value, Failure> {
    let mut arguments: evaluate::Arguments = read(words)?;
    arguments.setup.given = tasks.to_vec();
    Ok(evaluate::find(&arguments, stop)?.json(&arguments))
}

/// `optimize trial` with these words, and samples of its course each `every_s` seconds of
/// simulated time from the start of the search on.
///
/// # Errors
/// As the command fails.
pub fn trial(
    words: &[String],
    tasks: &[Source],
    every_s: f64,
) -> Result<(Value, Vec<Sample>), Failure> {
    let mut arguments: trial::Arguments = read(words)?;
    arguments.setup.given = tasks.to_vec();
    let found = trial::find(&arguments, Some(every_s))?;
    Ok((found.json(&arguments), found.samples))
}

/// `optimize stiffness` with these words.
///
/// # Errors
/// As the command fails.
pub fn stiffness(words: &[String]) -> Result<Value, Failure> {
    let arguments: stiffness::Arguments = read(words)?;
    arguments.json()
}

/// The stiffness predicted for an infill, density in percent and direction in degrees, as
/// evaluations carry it; `data` is the path of a CSV file in place of the shipped one.
///
/// # Errors
/// If the file cannot be used.
pub fn predict(density: f64, direction: f64, data: Option<&str>) -> Result<Value, Failure> {
    let finger = setup::printed_finger(setup::DEFAULT_FINGER)?;
    let model = setup::surrogate(&setup::stiffness_data(data, &finger)?, &finger)?;
    let predicted: Prediction = model.predict(density, direction).map_err(Failure::input)?;
    Ok(json!(predicted))
}

/// The task file of this name or path, checked: what to call it in messages, and its text.
///
/// # Errors
/// If there is none, or it cannot be used.
pub fn task(name: &str) -> Result<Source, Failure> {
    let source = setup::find("task", TASKS, name)?;
    check_task(&source)?;
    Ok(source)
}

/// Checks the text of a task file.
///
/// # Errors
/// If it cannot be used; the text names the key.
pub fn check_task(source: &Source) -> Result<(), Failure> {
    Task::parse(&source.text, &source.file).map_err(Failure::input)?;
    Ok(())
}

/// The parameters of the space of this name or path, as the first line of `ask-tell` has them.
///
/// # Errors
/// If there is none, or it cannot be used.
pub fn space(name: &str) -> Result<Value, Failure> {
    let source = setup::find("space", SPACES, name)?;
    let space = Space::parse(&source.text, &source.file).map_err(Failure::input)?;
    let line = |parameter: &Parameter| {
        let Parameter { key, low, high, step, .. } = parameter;
        json!({"name": key, "low": low, "high": high, "step": step})
    };
    Ok(space.parameters().iter().map(line).collect())
}

/// The fields of a task file, which is checked.
///
/// # Errors
/// If it cannot be used.
pub fn task_fields(source: &Source) -> Result<Value, Failure> {
    check_task(source)?;
    let table: toml::Table = input::read(&source.text, &source.file).map_err(Failure::input)?;
    Ok(json!(table))
}

/// The text of the task file with these fields, which are checked; `file` is named in errors.
///
/// # Errors
/// If they make no task file.
pub fn task_text(file: &str, fields: &Value) -> Result<String, Failure> {
    let text =
        toml::to_string(fields).map_err(|error| Failure::usage(format!("{file}: {error}")))?;
    check_task(&Source { file: file.to_owned(), text: text.clone() })?;
    Ok(text)
}

/// The folder of the study of `optimize` with these words, which are checked; nothing is written.
///
/// # Errors
/// As the command fails before it begins the study.
pub fn study_folder(words: &[String], tasks: &[Source]) -> Result<PathBuf, Failure> {
    let mut arguments: study::Arguments = read(words)?;
    arguments.setup.given = tasks.to_vec();
    Ok(arguments.look()?.2)
}

/// A study that is read from its folder, running or not.
pub struct Read {
    dir: PathBuf,
    record: StudyRecord,
}

impl Read {
    /// Reads the study in a folder.
    ///
    /// # Errors
    /// If there is none, or it is damaged.
    pub fn new(dir: &Path) -> Result<Self, Failure> {
        Ok(Read { dir: dir.to_owned(), record: StudyRecord::load(dir)? })
    }

    /// What was asked for, as `study.toml` has it.
    pub fn config(&self) -> Value {
        json!(self.record.config)
    }

    /// How many evaluations its journal holds.
    pub fn length(&self) -> usize {
        self.record.evaluations.len()
    }

    /// The `recommended` design of `--json`; of several objectives the first of the front. Null
    /// while there is none.
    pub fn best(&self) -> Value {
        let recommended = recommended::to_json(&self.record)["recommended"].take();
        match (recommended.is_null(), self.record.front().first()) {
            (true, Some(first)) if self.record.config.objective.single().is_none() => {
                summary::recorded_json(&self.record, first)
            }
            _ => recommended,
        }
    }

    /// The text of `evaluations.csv`.
    ///
    /// # Errors
    /// If a cell cannot be written.
    pub fn table(&self) -> Result<String, Failure> {
        Ok(evaluations_csv(&self.dir, &self.record)?)
    }

    /// The answer as a piece of HTML.
    pub fn card(&self) -> String {
        report::card(&self.record)
    }
}

/// The words of a study or of `resume`: where it is measured, and whether quietly.
///
/// # Errors
/// If they are none.
pub fn session(words: &[String]) -> Result<(Option<String>, bool), Failure> {
    let session = match words {
        [first, rest @ ..] if first == "resume" => read::<resume::Arguments>(rest)?.session,
        words => read::<study::Arguments>(words)?.session,
    };
    Ok((session.executor, session.quiet))
}
