//! An optimizer behind the lines of `optimize ask-tell`.

use ask_tell::protocol;
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};

/// A conversation; `docs/guide/python.md` describes its lines.
#[pyclass]
pub struct Session(Mutex<protocol::Session>);

#[pymethods]
impl Session {
    #[new]
    fn new() -> Self {
        Session(Mutex::new(protocol::Session::new()))
    }

    /// The answer to a line; the first line, if it is good, has none.
    fn answer(&self, py: Python<'_>, line: &str) -> Option<String> {
        py.allow_threads(|| self.0.lock().unwrap_or_else(PoisonError::into_inner).answer(line))
    }
}
