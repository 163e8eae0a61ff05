//! Conversion of failures to exceptions, with the texts of the command line.

use finger_opt::Failure;
use input::Place;
use pyo3::PyTypeInfo;
use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

pyo3::create_exception!(
    finger_opt,
    InputError,
    PyValueError,
    "Invalid argument or input file; the text gives the accepted values.\n\n\
     `file`, `line` (from 1) and `key` (field, column or argument) are the place of the error; None if unknown."
);
pyo3::create_exception!(finger_opt, TaskError, InputError, "Invalid or missing task file.");
pyo3::create_exception!(
    finger_opt,
    StudyError,
    PyRuntimeError,
    "Failure at run time; earlier results of a study are saved."
);
pyo3::create_exception!(
    finger_opt,
    Refused,
    StudyError,
    "Result that does not belong to its work; it is discarded."
);
pyo3::create_exception!(
    finger_opt,
    Interrupted,
    PyKeyboardInterrupt,
    "Cancelled by Ctrl-C; earlier results of a study are saved."
);

/// Adds the exceptions to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    for (name, class, own) in [
        ("InputError", InputError::type_object(py), true),
        ("TaskError", TaskError::type_object(py), false),
        ("StudyError", StudyError::type_object(py), true),
        ("Refused", Refused::type_object(py), false),
        ("Interrupted", Interrupted::type_object(py), true),
    ] {
        for place in ["file", "key", "line"].iter().filter(|_| own) {
            class.setattr(*place, py.None())?;
        }
        module.add(name, class)?;
    }
    Ok(())
}

/// Number of the process that owns the shared threads of all simulations; 0 before they exist.
static OWNER: AtomicU32 = AtomicU32::new(0);

/// Checks that the threads of the library belong to this process.
///
/// # Errors
/// After a fork, which does not copy threads: this process would wait for them forever.
pub fn check_not_forked() -> PyResult<()> {
    let own = std::process::id();
    match OWNER.compare_exchange(0, own, Ordering::SeqCst, Ordering::SeqCst) {
        Err(other) if other != own => Err(StudyError::new_err(
            "this process was forked after finger_opt had started threads; use the spawn or \
             forkserver start method",
        )),
        _ => Ok(()),
    }
}

/// Converts a failure to an exception.
pub fn exception(failure: Failure) -> PyErr {
    let (text, place) = (failure.to_string(), failure.place());
    with_place(
        place,
        match failure {
            Failure::Input(_) => InputError::new_err(text),
            Failure::Task(_) => TaskError::new_err(text),
            Failure::Run(_) => StudyError::new_err(text),
            Failure::Interrupted(_) => Interrupted::new_err(text),
        },
    )
}

/// Sets the place of an exception.
pub fn with_place(place: Place, error: PyErr) -> PyErr {
    let Place { file, line, key } = place;
    let set = Python::with_gil(|py| {
        let value = error.value(py);
        file.map_or(Ok(()), |file| value.setattr("file", file))?;
        line.map_or(Ok(()), |line| value.setattr("line", line))?;
        key.map_or(Ok(()), |key| value.setattr("key", key))
    });
    // The text includes the place as well.
    set.map_or_else(|other| other, |()| error)
}

/// Converts an exception raised by a signal: Ctrl-C becomes the library's error.
pub fn signalled(error: PyErr) -> PyErr {
    match Python::with_gil(|py| error.get_type(py).is(&PyKeyboardInterrupt::type_object(py))) {
        true => Interrupted::new_err("interrupted"),
        false => error,
    }
}
