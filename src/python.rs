//! The interpreter in which the Python package is installed.

use std::ffi::OsString;
use std::process::Command;

/// Environment variable for another interpreter than `python3`.
pub const PYTHON: &str = "FINGER_OPT_PYTHON";
/// Environment variable that excludes the current folder from imports, also of child processes.
const SAFE_PATH: (&str, &str) = ("PYTHONSAFEPATH", "1");
/// The same for Python 3.10, which ignores the variable.
const SAFE: &str = "import sys; sys.path[:] = filter(None, sys.path); ";

/// Returns the interpreter.
pub fn interpreter() -> OsString {
    std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into())
}

/// Returns the command that runs some code.
pub fn command(code: &str) -> Command {
    let mut command = Command::new(interpreter());
    command.args(["-c", &format!("{SAFE}{code}")]).envs([SAFE_PATH]);
    command
}
