//! Evaluations, trials, stiffness and task files.

use crate::errors::{InputError, StudyError, not_forked, raise, signalled};
use crate::keywords::{Keywords, Name, TaskWord, wrong};
use finger_opt::cli;
use finger_opt::session::{
    EvaluateRequest, IdentifyRequest, LeversRequest, MapRequest, StiffnessRequest, TaskFile,
    TrialRequest,
};
use finger_opt::session::{read_space, read_task};
use input::shipped::Source;
use insertion::space::Variable;
use insertion::trial::Sample;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

/// How often a long call looks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(100);

/// Runs `work`, which may use the threads that all share, without the interpreter's lock.
pub fn released<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    not_forked()?;
    Ok(py.allow_threads(work))
}

/// The same for what takes long: Ctrl-C sets the flag that `work` is given, and is raised when
/// `work` has ended.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> PyResult<T> {
    not_forked()?;
    let stop = AtomicBool::new(false);
    watched(py, &stop, || work(&stop))
}

/// Runs `work`, which shares no threads, without the interpreter's lock. Ctrl-C sets `stop`, and is
/// raised when `work` has ended.
pub fn watched<T: Send>(
    py: Python<'_>,
    stop: &AtomicBool,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    py.allow_threads(|| {
        std::thread::scope(|scope| {
            let (sender, receiver) = mpsc::channel();
            // The receiver is there until the scope ends.
            scope.spawn(move || sender.send(work()));
            let mut signal = Ok(());
            loop {
                match receiver.recv_timeout(LOOK) {
                    Ok(done) => return signal.map(|()| done),
                    Err(RecvTimeoutError::Timeout) if signal.is_ok() => {
                        signal = Python::with_gil(|py| py.check_signals()).map_err(signalled);
                        stop.fetch_or(signal.is_err(), Ordering::SeqCst);
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => {
                        return Err(StudyError::new_err("the simulation broke off"));
                    }
                }
            }
        })
    })
}

/// How windows are measured, of no finger yet.
pub fn windows(words: &Keywords<'_>, tasks: Vec<TaskWord>) -> PyResult<EvaluateRequest> {
    let seed = words.take("seed")?;
    let request = EvaluateRequest {
        setup: words.setup(tasks)?,
        walk: words.flag("walk")?,
        uncertainty: words.text("uncertainty")?,
        seed: seed.unwrap_or(0),
        ..EvaluateRequest::default()
    };
    match seed.is_some() && request.uncertainty.is_none() {
        true => Err(wrong("seed", "goes with uncertainty")),
        false => Ok(request),
    }
}

/// The window of a finger, as JSON.
#[pyfunction]
#[pyo3(signature = (tasks, /, **settings))]
pub fn evaluate<'py>(
    py: Python<'py>,
    tasks: Vec<TaskWord>,
    settings: Option<&Bound<'py, PyDict>>,
) -> PyResult<String> {
    let words = Keywords::new(py, settings)?;
    let request = EvaluateRequest {
        finger: words.finger()?,
        repeat: words.repeat()?,
        ..windows(&words, tasks)?
    };
    words.finish()?;
    let found = interruptible(py, |stop| request.run(stop))?.map_err(raise)?;
    Ok(cli::evaluate::json(&found).to_string())
}

/// What would help a finger more than its infill, as JSON and as a picture.
#[pyfunction]
#[pyo3(signature = (tasks, /, **settings))]
pub fn levers<'py>(
    py: Python<'py>,
    tasks: Vec<TaskWord>,
    settings: Option<&Bound<'py, PyDict>>,
) -> PyResult<(String, String)> {
    let words = Keywords::new(py, settings)?;
    let request = LeversRequest { setup: words.setup(tasks)?, finger: words.finger()? };
    words.finish()?;
    let found = interruptible(py, |stop| request.run(stop))?.map_err(raise)?;
    Ok((report::levers::json(&found).to_string(), report::levers::svg(&found)))
}

/// What logs say of their cell, as JSON and as a page.
#[pyfunction]
#[pyo3(signature = (tasks, /, **settings))]
pub fn identify<'py>(
    py: Python<'py>,
    tasks: Vec<TaskWord>,
    settings: Option<&Bound<'py, PyDict>>,
) -> PyResult<(String, String)> {
    let words = Keywords::new(py, settings)?;
    let request = IdentifyRequest {
        setup: words.setup(tasks)?,
        runs: words.take("runs")?.unwrap_or_default(),
        frame: words.take("frame")?,
        out: words.take("out")?,
        report: words.take("report")?,
        priors: words.text("priors")?.unwrap_or_else(|| "bench".to_owned()),
        seed: words.take("seed")?.unwrap_or(0),
    };
    words.finish()?;
    let done = interruptible(py, |stop| request.run(stop))?.map_err(raise)?;
    Ok((report::identify::json(&done).to_string(), report::identify::html(&done)))
}

/// JSON of the trial, by name the columns of its course: little-endian float64, and the page that
/// plays it if `film` is true.
#[pyfunction]
#[pyo3(signature = (tasks, /, **settings))]
pub fn trial<'py>(
    py: Python<'py>,
    tasks: Vec<TaskWord>,
    settings: Option<&Bound<'py, PyDict>>,
) -> PyResult<(String, Bound<'py, PyDict>, Option<String>)> {
    let words = Keywords::new(py, settings)?;
    let request = TrialRequest {
        setup: words.setup(tasks)?,
        finger: words.finger()?,
        offset_mm: words.take("offset_mm")?.unwrap_or(0.0),
        repeat: words.repeat()?,
        every_s: words.take("every_s")?,
        film: words.film()?,
        svg: words.take("svg")?,
        log: words.take("log")?,
        probe: words.flag("probe")?,
    };
    words.finish()?;
    let done = interruptible(py, |stop| request.run(stop))?.map_err(raise)?;
    let columns = PyDict::new(py);
    let column = |name: &str, of: &dyn Fn(&Sample) -> Vec<f64>| {
        let bytes: Vec<u8> = done.samples.iter().flat_map(of).flat_map(f64::to_le_bytes).collect();
        columns.set_item(name, PyBytes::new(py, &bytes))
    };
    column("time_s", &|sample| vec![sample.time_s])?;
    column("phase", &|sample| vec![f64::from(sample.phase)])?;
    column("tcp_mm", &|sample| sample.tcp_mm.to_vec())?;
    column("tip_mm", &|sample| sample.tip_mm.to_vec())?;
    column("tilt_deg", &|sample| vec![sample.tilt_deg])?;
    column("force_n", &|sample| sample.force_n.to_vec())?;
    column("slip_mm", &|sample| vec![sample.slip_mm])?;
    Ok((cli::trial::json(&done).to_string(), columns, done.page))
}

/// The capture map of a finger, as JSON and as a picture.
#[pyfunction]
#[pyo3(signature = (tasks, /, **settings))]
pub fn capture_map<'py>(
    py: Python<'py>,
    tasks: Vec<TaskWord>,
    settings: Option<&Bound<'py, PyDict>>,
) -> PyResult<(String, String)> {
    let words = Keywords::new(py, settings)?;
    let request = MapRequest {
        setup: words.setup(tasks)?,
        finger: words.finger()?,
        axes: words.choice("axes")?.unwrap_or_default(),
        svg: words.take("svg")?,
    };
    words.finish()?;
    let (chosen, map) = interruptible(py, |stop| request.run(stop))?.map_err(raise)?;
    let picture = report::map::svg(&map).map_err(|error| raise(error.into()))?;
    Ok((cli::map::json(&chosen, &map).to_string(), picture))
}

/// Every outcome as a map has it: number, words, colour.
#[pyfunction]
pub fn outcomes() -> Vec<(i8, &'static str, String)> {
    report::map::outcomes().into()
}

/// How well the stiffness model fits, as JSON and as a picture.
#[pyfunction]
#[pyo3(signature = (*, stiffness_data=None, finger=None))]
pub fn stiffness(
    py: Python<'_>,
    stiffness_data: Option<Name>,
    finger: Option<Name>,
) -> PyResult<(String, String)> {
    let request = stiffness_request(stiffness_data, finger);
    let model = released(py, || request.model())?.map_err(raise)?;
    let picture = report::stiffness::svg(&model).map_err(|error| raise(error.into()))?;
    Ok((report::stiffness::json(&model).to_string(), picture))
}

/// The stiffness predicted for an infill, density in percent and direction in degrees, as JSON.
#[pyfunction]
#[pyo3(signature = (density, direction, *, stiffness_data=None, finger=None))]
pub fn predict(
    py: Python<'_>,
    density: f64,
    direction: f64,
    stiffness_data: Option<Name>,
    finger: Option<Name>,
) -> PyResult<String> {
    let request = stiffness_request(stiffness_data, finger);
    let predicted = released(py, || request.predict(density, direction))?.map_err(raise)?;
    Ok(json!(predicted).to_string())
}

/// The stiffness model of these measurements, or of the shipped ones.
fn stiffness_request(data: Option<Name>, finger: Option<Name>) -> StiffnessRequest {
    let usual = StiffnessRequest::default();
    let finger = finger.map_or(usual.finger, |Name(name)| name);
    StiffnessRequest { stiffness_data: data.map(|Name(name)| name), finger }
}

/// The parameters of a space as the first line of `ask-tell` has them, as JSON.
#[pyfunction]
pub fn space(name: Name) -> PyResult<String> {
    let space = read_space(&name.0).map_err(raise)?;
    let line = |parameter: &Variable| {
        let Variable { key, low, high, step, .. } = parameter;
        json!({"name": key, "low": low, "high": high, "step": step})
    };
    Ok(space.parameters.iter().map(line).collect::<Value>().to_string())
}

/// Name in messages and text of the task file of this name or path.
#[pyfunction]
pub fn task(name: Name) -> PyResult<(String, String)> {
    let source = read_task(&name.0).map_err(raise)?.source;
    Ok((source.file, source.text))
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
