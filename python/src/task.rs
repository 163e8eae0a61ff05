//! Task and space files, and the words for outcomes.

use crate::errors::{InputError, raise};
use finger_opt::setup::task::{TaskFile, read_space, read_task};
use input::shipped::Source;
use insertion::space::Variable;
use pyo3::prelude::*;
use serde_json::{Value, json};

/// Every outcome as a map has it: number, words, colour.
#[pyfunction]
pub fn outcomes() -> Vec<(i8, &'static str, String)> {
    report::map::outcomes().into()
}

/// The parameters of a space as the first line of `ask-tell` has them, as JSON.
#[pyfunction]
pub fn space(name: &str) -> PyResult<String> {
    let space = read_space(name).map_err(raise)?;
    let line = |parameter: &Variable| {
        let Variable { key, low, high, step, .. } = parameter;
        json!({"name": key, "low": low, "high": high, "step": step})
    };
    Ok(space.parameters.iter().map(line).collect::<Value>().to_string())
}

/// Name in messages and text of the task file of this name or path, checked.
#[pyfunction]
pub fn task(name: &str) -> PyResult<(String, String)> {
    let Source { file, text } = read_task(name).map_err(raise)?.source;
    Ok((file, text))
}

/// The fields of a task file, checked, as JSON.
#[pyfunction]
pub fn task_fields(file: String, text: String) -> PyResult<String> {
    let fields = TaskFile::fields(Source { file, text }).map_err(raise)?;
    Ok(json!(fields).to_string())
}

/// The text of a task file with these fields, given as JSON; checked.
#[pyfunction]
pub fn task_text(file: &str, fields: &str) -> PyResult<String> {
    let fields: Value = serde_json::from_str(fields)
        .map_err(|error| InputError::new_err(format!("{file}: {error}")))?;
    Ok(TaskFile::of_fields(file, &fields).map_err(raise)?.source.text)
}
