//! Failures as exceptions, with the texts of the command line.

use finger_opt::session::Failure;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

pyo3::create_exception!(
    finger_opt,
    InputError,
    PyValueError,
    "A wrong argument or input file; the text says what would be right."
);
pyo3::create_exception!(
    finger_opt,
    RunError,
    PyRuntimeError,
    "Something failed while running; what was measured before is safe."
);

pyo3::create_exception!(
    finger_opt,
    Refused,
    RunError,
    "A result that cannot be one of the work it is said to be of; nothing of it is believed."
);

/// The process that has the threads which all simulations share; 0 before there are any.
static PROCESS: AtomicU32 = AtomicU32::new(0);

/// Whether the threads of the library are those of this process.
///
/// # Errors
/// If they were left behind by a fork: this process would wait for them for ever.
pub fn not_forked() -> PyResult<()> {
    let own = std::process::id();
    match PROCESS.compare_exchange(0, own, Ordering::SeqCst, Ordering::SeqCst) {
        Err(other) if other != own => Err(RunError::new_err(
            "this process was forked after finger_opt had started threads; use the spawn or \
             forkserver start method",
        )),
        _ => Ok(()),
    }
}

/// The exception of a failure.
pub fn raise(failure: Failure) -> PyErr {
    match failure {
        Failure::Input(error) => InputError::new_err(error.to_string()),
        Failure::Run(error) => RunError::new_err(error.to_string()),
    }
}
