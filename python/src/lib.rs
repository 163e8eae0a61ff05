//! `finger_opt._native`: what the Python package calls. Keyword arguments in, JSON out;
//! the package in `finger_opt/` gives both their Python shape.
#![forbid(unsafe_code)]

mod commands;
mod errors;
mod import;
mod insertion;
mod keywords;
mod measure;
mod optimizer;
mod study;
mod sweep;

use finger_opt::cli;
use pyo3::prelude::*;
use std::ffi::OsString;
use std::process::ExitCode;

/// Runs `optimize` with these arguments, the program's name first; gives the exit code.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    let code = py.allow_threads(|| cli::main(arguments));
    u8::from(code != ExitCode::SUCCESS) * if code == ExitCode::from(2) { 2 } else { 1 }
}

/// The commands of `optimize` with their options, as JSON.
#[pyfunction(name = "commands")]
fn command_list() -> String {
    cli::commands().to_string()
}

/// The extension module.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    errors::register(module)?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(command_list, module)?)?;
    module.add_function(wrap_pyfunction!(measure::evaluate, module)?)?;
    module.add_function(wrap_pyfunction!(measure::identify, module)?)?;
    module.add_function(wrap_pyfunction!(measure::levers, module)?)?;
    module.add_function(wrap_pyfunction!(measure::trial, module)?)?;
    module.add_function(wrap_pyfunction!(measure::capture_map, module)?)?;
    module.add_function(wrap_pyfunction!(measure::outcomes, module)?)?;
    module.add_function(wrap_pyfunction!(measure::stiffness, module)?)?;
    module.add_function(wrap_pyfunction!(measure::predict, module)?)?;
    module.add_function(wrap_pyfunction!(measure::space, module)?)?;
    module.add_function(wrap_pyfunction!(import::import_parts, module)?)?;
    module.add_function(wrap_pyfunction!(measure::task, module)?)?;
    module.add_function(wrap_pyfunction!(measure::task_fields, module)?)?;
    module.add_function(wrap_pyfunction!(measure::task_text, module)?)?;
    module.add_function(wrap_pyfunction!(commands::finger, module)?)?;
    module.add_function(wrap_pyfunction!(commands::new_task, module)?)?;
    module.add_function(wrap_pyfunction!(commands::check_task, module)?)?;
    module.add_function(wrap_pyfunction!(commands::tune_task, module)?)?;
    module.add_function(wrap_pyfunction!(commands::compare, module)?)?;
    module.add_function(wrap_pyfunction!(commands::calibrate, module)?)?;
    module.add_function(wrap_pyfunction!(commands::next_print, module)?)?;
    module.add_function(wrap_pyfunction!(commands::sensitivity, module)?)?;
    module.add_function(wrap_pyfunction!(commands::export_finger, module)?)?;
    module.add_function(wrap_pyfunction!(commands::export_mjcf, module)?)?;
    module.add_function(wrap_pyfunction!(commands::measurements, module)?)?;
    module.add_function(wrap_pyfunction!(commands::add_measurement, module)?)?;
    module.add_function(wrap_pyfunction!(commands::measuring_sheet, module)?)?;
    module.add_function(wrap_pyfunction!(commands::report_of, module)?)?;
    module.add_function(wrap_pyfunction!(commands::robots, module)?)?;
    module.add_function(wrap_pyfunction!(commands::tasks, module)?)?;
    module.add_class::<optimizer::Session>()?;
    module.add_class::<insertion::Insertion>()?;
    module.add_class::<sweep::Sweep>()?;
    module.add_function(wrap_pyfunction!(study::perform, module)?)?;
    module.add_function(wrap_pyfunction!(study::source_sha256, module)?)?;
    module.add_function(wrap_pyfunction!(study::study, module)?)?;
    module.add_function(wrap_pyfunction!(study::resume, module)?)?;
    module.add_function(wrap_pyfunction!(study::asked, module)?)?;
    module.add_class::<study::Stop>()?;
    module.add_class::<study::Asked>()?;
    module.add_class::<study::Recorded>()?;
    module.add_class::<study::Guided>()?;
    Ok(())
}
