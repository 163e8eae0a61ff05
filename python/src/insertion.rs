//! Trial driven from Python.

use crate::call::{interruptible, read};
use crate::errors::{InputError, exception, with_place};
use finger_opt::commands::evaluate::Request;
use finger_opt::keywords::request;
use finger_opt::setup::driven;
use input::Place;
use insertion::trial::State;
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Grasped part in front of its socket.
#[pyclass(frozen)]
pub struct Insertion(Mutex<driven::Insertion>);

/// Numbers of a state in the order of its fields, the outcome, and the failure class.
type StateTuple = (Vec<f64>, Option<&'static str>, Option<u8>);

impl Insertion {
    fn lock(&self) -> MutexGuard<'_, driven::Insertion> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Insertion {
    /// Returns an insertion with the task and the finger of an evaluation.
    #[new]
    fn new(py: Python<'_>, keywords: &str) -> PyResult<Self> {
        let keywords = read(keywords)?;
        let made = interruptible(py, |stop| {
            let Request { setup, finger, .. } = request(&keywords)?;
            driven::Insertion::new(&setup, &finger, stop)
        })?;
        Ok(Insertion(Mutex::new(made.map_err(exception)?)))
    }

    /// Restarts with the start shifted along y, mm.
    fn start(&self, py: Python<'_>, offset_mm: f64) -> PyResult<StateTuple> {
        check_finite("offset_mm", &[offset_mm])?;
        Ok(state_tuple(&py.allow_threads(|| self.lock().start(offset_mm))))
    }

    /// Runs a control step.
    fn step(&self, py: Python<'_>, velocity_mm_per_s: [f64; 3]) -> PyResult<StateTuple> {
        check_finite("velocity", &velocity_mm_per_s)?;
        Ok(state_tuple(&py.allow_threads(|| self.lock().step(velocity_mm_per_s))))
    }
}

fn check_finite(name: &str, numbers: &[f64]) -> PyResult<()> {
    if numbers.iter().all(|number| number.is_finite()) {
        return Ok(());
    }
    let error = InputError::new_err(format!("{name}: must be finite"));
    Err(with_place(Place::default().key(name), error))
}

fn state_tuple(state: &State) -> StateTuple {
    let mut numbers = vec![state.time_s];
    numbers.extend(state.tcp_mm.iter().chain(&state.turn_deg).chain(&state.force_n));
    numbers.extend(state.tip_mm);
    numbers.extend([state.tilt_deg, state.slip_mm, state.distance_mm]);
    (numbers, state.outcome.map(|o| o.word()), state.outcome.and_then(|o| o.failure()))
}
