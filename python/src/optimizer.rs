//! Ask-and-tell session with an optimizer.

use crate::errors::InputError;
use ask_tell::protocol;
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Session with one optimizer; `docs/guide/python.md` describes its lines.
#[pyclass]
#[derive(Default)]
pub struct Session(Mutex<protocol::Session>);

#[pymethods]
impl Session {
    #[new]
    fn new() -> Self {
        Session::default()
    }

    /// Returns the answer to a line; a valid first line has none.
    fn answer(&self, py: Python<'_>, line: &str) -> PyResult<Option<String>> {
        let session = || self.0.lock().unwrap_or_else(PoisonError::into_inner).answer(line);
        py.allow_threads(session).map_err(InputError::new_err)
    }
}
