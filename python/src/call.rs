//! Commands, run without the interpreter's lock.

use crate::errors::{InputError, StudyError, check_not_forked, exception, signalled};
use finger_opt::commands::COMMANDS;
use finger_opt::{Context, Output, keywords};
use pyo3::prelude::*;
use serde_json::{Map, Value};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

/// Interval at which a long call checks for Ctrl-C.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(100);

/// Runs `work`, which may use the shared threads, without the interpreter's lock.
pub fn released<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    check_not_forked()?;
    Ok(py.allow_threads(work))
}

/// Runs long `work` without the interpreter's lock: Ctrl-C sets its flag and is raised once `work` has ended.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> PyResult<T> {
    check_not_forked()?;
    let stop = AtomicBool::new(false);
    watched(py, &stop, || work(&stop))
}

/// Runs `work`, which does not use the shared threads, without the interpreter's lock. Ctrl-C sets `stop` and is
/// raised once `work` has ended.
pub fn watched<T: Send>(
    py: Python<'_>,
    stop: &AtomicBool,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    py.allow_threads(|| {
        std::thread::scope(|scope| {
            let (sender, receiver) = mpsc::channel();
            // The receiver lives until the scope ends.
            scope.spawn(move || sender.send(work()));
            let mut signal = Ok(());
            loop {
                match receiver.recv_timeout(SIGNAL_INTERVAL) {
                    Ok(done) => return signal.map(|()| done),
                    Err(RecvTimeoutError::Timeout) if signal.is_ok() => {
                        signal = Python::with_gil(|py| py.check_signals()).map_err(signalled);
                        stop.fetch_or(signal.is_err(), Ordering::SeqCst);
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => {
                        return Err(StudyError::new_err("the simulation ended unexpectedly"));
                    }
                }
            }
        })
    })
}

/// Parses keywords from a JSON object.
pub fn read(keywords: &str) -> PyResult<Map<String, Value>> {
    serde_json::from_str(keywords).map_err(|error| InputError::new_err(error.to_string()))
}

/// Runs a command by its name (`task new`) with its options as a JSON object. Returns its result as JSON, and its
/// picture or page, if there is one.
#[pyfunction]
pub fn call(py: Python<'_>, command: &str, keywords: &str) -> PyResult<(String, Option<String>)> {
    let keywords = read(keywords)?;
    let called = interruptible(py, |stop| {
        keywords::call(COMMANDS, command, &keywords, &Context::silent(stop))
    })?;
    let Output { value, picture, .. } = called.map_err(exception)?;
    Ok((value.map_err(exception)?.to_string(), picture))
}
