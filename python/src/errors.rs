//! Failures as exceptions, with the texts of the command line.

use finger_opt::session::Failure;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

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

/// The exception of a failure.
pub fn raise(failure: Failure) -> PyErr {
    match failure {
        Failure::Input(error) => InputError::new_err(error.to_string()),
        Failure::Run(error) => RunError::new_err(error.to_string()),
    }
}
