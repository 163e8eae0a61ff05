//! `--executor WHERE`: passes the command to the installed Python package, which contains the executors.

use crate::Failure;
use crate::context::watch;
use crate::python::{PYTHON, command, interpreter, output};
use std::ffi::OsString;
use std::process::{ChildStdin, ExitCode, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use study::SOURCES;

/// Environment variable that passes the hash of this program's sources to the package, which compares it with its own.
const SOURCES_KEY: &str = "FINGER_OPT_SOURCES";

/// Runs the command line `words`, which begins after the program's name, in the Python package and returns the exit
/// code. The package reports its own errors.
pub fn run(executor: &str, words: &[OsString]) -> Result<ExitCode, Failure> {
    let python = interpreter();
    let missing = |message: &str| {
        Failure::running(format!(
            "--executor {executor} needs the Python package of finger-opt ({}: {message}); in \
             the project's folder: pip install './python[dask,slurm]'. {PYTHON} names another \
             interpreter",
            python.display()
        ))
    };
    output(&mut command("import finger_opt")).map_err(|message| missing(&message))?;
    // The package ends the study when its standard input closes, also if this process is killed. The signal handler is
    // installed before the package starts, since a signal may arrive at once; the lock makes it wait for the input.
    let input = Arc::new(Mutex::new(None));
    let watched = Arc::clone(&input);
    let mut held = locked(&input);
    watch(move || *locked(&watched) = None)?;
    let mut study = command("from finger_opt.executors import command; sys.exit(command())");
    let study = study.args(words).env(SOURCES_KEY, SOURCES).stdin(Stdio::piped()).spawn();
    let mut study = study.map_err(|error| missing(&error.to_string()))?;
    *held = study.stdin.take();
    drop(held);
    let status = study.wait().map_err(|error| Failure::running(error.to_string()))?;
    match status.code() {
        Some(code) => Ok(ExitCode::from(u8::try_from(code).unwrap_or(1))),
        None => Err(Failure::running(format!("the Python package was terminated: {status}"))),
    }
}

fn locked(input: &Mutex<Option<ChildStdin>>) -> MutexGuard<'_, Option<ChildStdin>> {
    input.lock().unwrap_or_else(PoisonError::into_inner)
}
