//! A trial that Python drives.

use crate::errors::raise;
use crate::keywords::{Keywords, TaskWord, wrong};
use crate::measure::interruptible;
use finger_opt::session;
use insertion::trial::State;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A grasped part in front of its socket.
#[pyclass(frozen)]
pub struct Insertion(Mutex<session::Insertion>);

/// The numbers of a state in the order of its fields, how it ended, and the failure class.
type Stand = (Vec<f64>, Option<&'static str>, Option<u8>);

impl Insertion {
    fn open(&self) -> MutexGuard<'_, session::Insertion> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Insertion {
    #[new]
    #[pyo3(signature = (tasks, /, **settings))]
    fn new<'py>(
        py: Python<'py>,
        tasks: Vec<TaskWord>,
        settings: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Self> {
        let words = Keywords::new(py, settings)?;
        let (setup, finger) = (words.setup(tasks)?, words.finger()?);
        words.finish()?;
        let make = |stop: &AtomicBool| session::Insertion::new(&setup, &finger, stop);
        Ok(Insertion(Mutex::new(interruptible(py, make)?.map_err(raise)?)))
    }

    /// Begins anew.
    fn start(&self, py: Python<'_>, offset_mm: f64) -> PyResult<Stand> {
        finite("offset_mm", &[offset_mm])?;
        Ok(stand(&py.allow_threads(|| self.open().start(offset_mm))))
    }

    /// A control step.
    fn step(&self, py: Python<'_>, velocity_mm_per_s: [f64; 3]) -> PyResult<Stand> {
        finite("velocity", &velocity_mm_per_s)?;
        Ok(stand(&py.allow_threads(|| self.open().step(velocity_mm_per_s))))
    }
}

fn finite(what: &str, numbers: &[f64]) -> PyResult<()> {
    match numbers.iter().all(|number| number.is_finite()) {
        true => Ok(()),
        false => Err(wrong(what, "has to be finite")),
    }
}

fn stand(state: &State) -> Stand {
    let mut numbers = vec![state.time_s];
    numbers.extend(state.tcp_mm.iter().chain(&state.turn_deg).chain(&state.force_n));
    numbers.extend(state.tip_mm);
    numbers.extend([state.tilt_deg, state.slip_mm, state.distance_mm]);
    (numbers, state.outcome.map(|o| o.word()), state.outcome.and_then(|o| o.failure()))
}
