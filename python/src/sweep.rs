//! Windows of many fingers as columns.

use crate::call::{read, released, watched};
use crate::errors::{InputError, check_not_forked, exception};
use crate::study::Stop;
use finger_opt::commands::evaluate::Request;
use finger_opt::keywords::request;
use finger_opt::studies::sweep;
use finger_opt::{FingerRequest, RunRequest, SetupRequest};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

/// Names of the columns of text.
const TEXT_COLUMNS: [&str; 6] = ["task", "robot", "cell", "finger_model", "rcc_from", "nominal"];

/// Settings of the measurement.
#[derive(clap::Args)]
struct SweepRequest {
    #[command(flatten)]
    setup: SetupRequest,
    #[arg(long)]
    walk: bool,
    #[command(flatten)]
    run: RunRequest,
}

/// Evaluator of many fingers on a task.
#[pyclass(frozen)]
pub struct Sweep(sweep::Sweep);

/// Columns of numbers (little-endian float64, NaN for missing ones) and of text.
type Columns<'py> = (Bound<'py, PyDict>, BTreeMap<&'static str, Vec<Option<String>>>);

#[pymethods]
impl Sweep {
    #[new]
    fn new(py: Python<'_>, keywords: &str) -> PyResult<Self> {
        let keywords = read(keywords)?;
        let sweep = released(py, || {
            let SweepRequest { setup, walk, run } = request(&keywords)?;
            sweep::Sweep::new(&Request { setup, walk, ..Request::default() }, &run)
        })?;
        Ok(Sweep(sweep.map_err(exception)?))
    }

    /// Measures one finger for each row of these columns: `density`, `direction`, and numbers of task and finger by
    /// their keys. Ends early once `stop` is set.
    #[pyo3(signature = (columns, stop=None))]
    fn measure<'py>(
        &self,
        py: Python<'py>,
        columns: BTreeMap<String, Vec<f64>>,
        stop: Option<&Stop>,
    ) -> PyResult<Columns<'py>> {
        let fingers = fingers(&columns)?;
        let own = AtomicBool::new(false);
        let stop = stop.map_or(&own, |Stop(stop)| stop);
        check_not_forked()?;
        let done = watched(py, stop, || {
            let found = self.0.measure(&fingers, stop)?;
            Ok(found.iter().map(|found| flat(json!(found))).collect::<Vec<_>>())
        })?;
        let rows: Vec<BTreeMap<String, Value>> = done.map_err(exception)?;
        let numbers = PyDict::new(py);
        let mut names: Vec<&String> = rows.iter().flat_map(BTreeMap::keys).collect();
        names.sort_unstable();
        names.dedup();
        for name in names.into_iter().filter(|name| !TEXT_COLUMNS.contains(&name.as_str())) {
            let number = |row: &BTreeMap<String, Value>| match row.get(name) {
                Some(Value::Bool(flag)) => f64::from(u8::from(*flag)),
                // The outcome `diverged`, by its number in a capture map.
                Some(Value::String(_)) => -1.0,
                value => value.and_then(Value::as_f64).unwrap_or(f64::NAN),
            };
            let bytes: Vec<u8> = rows.iter().map(number).flat_map(f64::to_le_bytes).collect();
            numbers.set_item(name, PyBytes::new(py, &bytes))?;
        }
        let word = |row: &BTreeMap<String, Value>, name| Some(row.get(name)?.as_str()?.to_owned());
        let column = |name| (name, rows.iter().map(|row| word(row, name)).collect());
        Ok((numbers, TEXT_COLUMNS.into_iter().map(column).collect()))
    }
}

/// Returns a finger for each row of the columns.
fn fingers(columns: &BTreeMap<String, Vec<f64>>) -> PyResult<Vec<FingerRequest>> {
    let rows = columns.values().next().map_or(0, Vec::len);
    let mut fingers = vec![FingerRequest::default(); rows];
    for (name, numbers) in columns {
        if numbers.len() != rows {
            let problem =
                format!("{name}: has {} rows, but another column has {rows}", numbers.len());
            return Err(InputError::new_err(problem));
        }
        for (finger, number) in fingers.iter_mut().zip(numbers) {
            match name.as_str() {
                "density" => finger.infill.density = Some(*number),
                "direction" => finger.infill.direction = Some(*number),
                "stiffness_compliance" => finger.stiffness_compliance = Some(*number),
                "stiffness_assembly" => finger.stiffness_assembly = Some(*number),
                key => finger.set.push((key.to_owned(), *number)),
            }
        }
    }
    Ok(fingers)
}

/// Returns the fields of an object; nested objects are merged, and the items of lists are numbered from 1.
fn flat(fields: Value) -> BTreeMap<String, Value> {
    let mut found = BTreeMap::new();
    let Value::Object(fields) = fields else { return found };
    for (name, value) in fields {
        match value {
            Value::Object(_) => found.extend(flat(value)),
            Value::Array(items) => {
                let items = items.into_iter().enumerate();
                found.extend(items.map(|(i, item)| (format!("{name}_{}", i + 1), item)));
            }
            value => drop(found.insert(name, value)),
        }
    }
    found
}
