//! Task and space files, and the words for outcomes.

use crate::errors::{InputError, exception};
use ask_tell::stream::stream;
use finger_opt::setup::task::read_space;
use finger_opt::{TaskFile, read_task};
use input::shipped::{PRIORS, ROBOTS, Source};
use insertion::{Priors, Variable};
use parameters::Parameter;
use pyo3::prelude::*;
use rand::RngExt;
use serde_json::{Value, json};

/// Returns all outcomes of a map: number, words, colour.
#[pyfunction]
pub fn outcomes() -> Vec<(i8, &'static str, String)> {
    report::map::outcomes().into()
}

/// Returns the parameters of a space in the form of the first line of `ask-tell`, as JSON.
#[pyfunction]
pub fn space(name: &str) -> PyResult<String> {
    let space = read_space(name).map_err(exception)?;
    let line = |parameter: &Variable| {
        let Variable { key, low, high, step, .. } = parameter;
        json!({"name": key, "low": low, "high": high, "step": step})
    };
    Ok(space.parameters.iter().map(line).collect::<Value>().to_string())
}

/// Reads and checks the task file of this name or path; returns its name in messages and its text.
#[pyfunction]
pub fn task(name: &str) -> PyResult<(String, String)> {
    let Source { file, text } = read_task(name).map_err(exception)?.source;
    Ok((file, text))
}

/// Checks a task file and returns its fields as JSON.
#[pyfunction]
pub fn task_fields(file: String, text: String) -> PyResult<String> {
    Ok(json!(TaskFile::fields(Source { file, text }).map_err(exception)?).to_string())
}

/// Returns the text of a task file with these fields, given as JSON, and checks it.
#[pyfunction]
pub fn task_text(file: &str, fields: &str) -> PyResult<String> {
    let fields: Value = serde_json::from_str(fields)
        .map_err(|error| InputError::new_err(format!("{file}: {error}")))?;
    Ok(TaskFile::of_fields(file, &fields).map_err(exception)?.source.text)
}

/// Draws a cell from the shipped priors; returns the text of its file, and its parameters as JSON.
#[pyfunction]
pub fn drawn_cell(seed: u64) -> PyResult<(String, String)> {
    let wrong = |error: &dyn std::fmt::Display| InputError::new_err(error.to_string());
    let shipped = &PRIORS[0];
    let priors = Priors::parse(shipped.text, shipped.file).map_err(|error| wrong(&error))?;
    let mut random = stream(seed, 0, "rehearsal");
    let drawn = |mut row: Parameter| {
        row.value = Some(row.at(random.random()));
        row.sd = Some(0.0);
        row
    };
    let parameters: Vec<Parameter> = priors.parameters.into_iter().map(drawn).collect();
    let rows = json!(parameters).to_string();
    // The priors are factors on the numbers of this robot.
    let robot = ROBOTS.iter().find(|robot| robot.name == "servo");
    let robot = robot.map(|robot| robot.text.parse()).transpose().map_err(|error| wrong(&error))?;
    let cell = Priors { parameters, robot, ..priors };
    Ok((toml::to_string(&cell).map_err(|error| wrong(&error))?, rows))
}
