//! `finger_opt._native`: native functions of the Python package in `finger_opt/`. Keywords and results are JSON.
#![forbid(unsafe_code)]

mod call;
mod errors;
mod insertion;
mod optimizer;
mod study;
mod sweep;
mod task;

use calibration::experiments::line::{LARGEST_FORCE_N, LARGEST_LENGTH_MM};
use finger_opt::{program, python};
use pyo3::prelude::*;
use std::ffi::OsString;
use std::process::ExitCode;

/// Runs `optimize` with these arguments, the program's name first; returns the exit code.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    let code = py.allow_threads(|| program::main(arguments));
    u8::from(code != ExitCode::SUCCESS) * if code == ExitCode::from(2) { 2 } else { 1 }
}

/// Defines the extension module.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    let executable: OsString = module.py().import("sys")?.getattr("executable")?.extract()?;
    // The library runs Python code with this interpreter. A second import would set the same path.
    let _ = python::OWN.set(executable);
    module.add("LARGEST_FORCE_N", LARGEST_FORCE_N)?;
    module.add("LARGEST_LENGTH_MM", LARGEST_LENGTH_MM)?;
    errors::register(module)?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(call::call, module)?)?;
    module.add_function(wrap_pyfunction!(task::outcomes, module)?)?;
    module.add_function(wrap_pyfunction!(task::space, module)?)?;
    module.add_function(wrap_pyfunction!(task::task, module)?)?;
    module.add_function(wrap_pyfunction!(task::task_fields, module)?)?;
    module.add_function(wrap_pyfunction!(task::task_text, module)?)?;
    module.add_function(wrap_pyfunction!(task::drawn_cell, module)?)?;
    module.add_function(wrap_pyfunction!(study::perform, module)?)?;
    module.add_function(wrap_pyfunction!(study::source_sha256, module)?)?;
    module.add_class::<optimizer::Session>()?;
    module.add_class::<insertion::Insertion>()?;
    module.add_class::<sweep::Sweep>()?;
    module.add_class::<study::Stop>()?;
    module.add_class::<study::StudyRequest>()?;
    module.add_class::<study::Recorded>()?;
    module.add_class::<study::AskTellStudy>()?;
    Ok(())
}
