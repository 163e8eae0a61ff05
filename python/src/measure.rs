//! Evaluations, trials, stiffness and task files.

use crate::errors::{InputError, raise};
use finger_opt::cli::call;
use input::shipped::Source;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

/// How often a long call looks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(100);

/// Task files in place of names: what to call each in messages, and its text.
pub type Files = Vec<(String, String)>;

pub fn sources(files: Files) -> Vec<Source> {
    files.into_iter().map(|(file, text)| Source { file, text }).collect()
}

/// Runs `work` without the interpreter's lock. Ctrl-C sets the flag that `work` is given,
/// and is raised when `work` has ended.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    py.allow_threads(|| {
        std::thread::scope(|scope| {
            let (sender, receiver) = mpsc::channel();
            let stop = &stop;
            // The receiver is there until the scope ends.
            scope.spawn(move || sender.send(work(stop)));
            let mut signal = Ok(());
            loop {
                match receiver.recv_timeout(LOOK) {
                    Ok(done) => return signal.map(|()| done),
                    Err(RecvTimeoutError::Timeout) if signal.is_ok() => {
                        signal = Python::with_gil(|py| py.check_signals());
                        stop.store(signal.is_err(), Ordering::SeqCst);
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => {
                        return Err(crate::errors::RunError::new_err("the simulation broke off"));
                    }
                }
            }
        })
    })
}

#[pyfunction]
pub fn evaluate(py: Python<'_>, words: Vec<String>, files: Files) -> PyResult<String> {
    let tasks = sources(files);
    let found = interruptible(py, |stop| call::evaluate(&words, &tasks, stop))?;
    Ok(found.map_err(raise)?.to_string())
}

/// JSON of the trial, and by name the columns of its course: little-endian float64.
#[pyfunction]
pub fn trial<'py>(
    py: Python<'py>,
    words: Vec<String>,
    files: Files,
    every_s: f64,
) -> PyResult<(String, Bound<'py, PyDict>)> {
    if !(every_s.is_finite() && every_s >= 0.0) {
        return Err(InputError::new_err("every_s: is a time in s, 0 or above"));
    }
    let tasks = sources(files);
    let found = interruptible(py, |_| call::trial(&words, &tasks, every_s))?;
    let (fields, samples) = found.map_err(raise)?;
    let columns = PyDict::new(py);
    let column = |name: &str, of: &dyn Fn(&insertion::trial::Sample) -> Vec<f64>| {
        let bytes: Vec<u8> = samples.iter().flat_map(of).flat_map(f64::to_le_bytes).collect();
        columns.set_item(name, PyBytes::new(py, &bytes))
    };
    column("time_s", &|sample| vec![sample.time_s])?;
    column("phase", &|sample| vec![f64::from(sample.phase)])?;
    column("tcp_mm", &|sample| sample.tcp_mm.to_vec())?;
    column("tip_mm", &|sample| sample.tip_mm.to_vec())?;
    column("tilt_deg", &|sample| vec![sample.tilt_deg])?;
    column("force_n", &|sample| sample.force_n.to_vec())?;
    column("slip_mm", &|sample| vec![sample.slip_mm])?;
    Ok((fields.to_string(), columns))
}

#[pyfunction]
pub fn stiffness(py: Python<'_>, words: Vec<String>) -> PyResult<String> {
    Ok(py.allow_threads(|| call::stiffness(&words)).map_err(raise)?.to_string())
}

#[pyfunction]
pub fn predict(
    py: Python<'_>,
    density: f64,
    direction: f64,
    data: Option<String>,
) -> PyResult<String> {
    let predicted = py.allow_threads(|| call::predict(density, direction, data.as_deref()));
    Ok(predicted.map_err(raise)?.to_string())
}

/// The parameters of a space, as JSON.
#[pyfunction]
pub fn space(name: &str) -> PyResult<String> {
    Ok(call::space(name).map_err(raise)?.to_string())
}

/// Name in messages and text of the task file of this name or path.
#[pyfunction]
pub fn task(name: &str) -> PyResult<(String, String)> {
    let source = call::task(name).map_err(raise)?;
    Ok((source.file, source.text))
}

/// The fields of a task file, checked, as JSON.
#[pyfunction]
pub fn task_fields(file: String, text: String) -> PyResult<String> {
    call::task_fields(&Source { file, text }).map(|fields| fields.to_string()).map_err(raise)
}

/// The text of a task file with these fields, given as JSON; checked.
#[pyfunction]
pub fn task_text(file: &str, fields: &str) -> PyResult<String> {
    let fields = serde_json::from_str(fields)
        .map_err(|error| InputError::new_err(format!("{file}: {error}")))?;
    call::task_text(file, &fields).map_err(raise)
}
