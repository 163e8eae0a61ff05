//! The interpreter in which the Python package is installed.

use input::{Fault, Place};
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::OnceLock;

/// Environment variable for another interpreter than `python3`.
pub const PYTHON: &str = "FINGER_OPT_PYTHON";
/// Environment variable that excludes the current folder from imports, also in child processes.
const SAFE_PATH: (&str, &str) = ("PYTHONSAFEPATH", "1");
/// The same for Python 3.10, which ignores the variable.
const SAFE: &str = "import sys; sys.path[:] = filter(None, sys.path); ";

/// Interpreter in which this library is loaded.
pub static OWN: OnceLock<OsString> = OnceLock::new();

/// Returns the interpreter.
pub fn interpreter() -> OsString {
    let own = || OWN.get().cloned().unwrap_or_else(|| "python3".into());
    std::env::var_os(PYTHON).unwrap_or_else(own)
}

/// Format of files that the package reads by one of its extras.
pub struct Format {
    /// Noun phrase with its article: `a STEP file`.
    pub name: &'static str,
    /// Extra of the package.
    pub extra: &'static str,
    /// Code that prints the contents of the file `sys.argv[1]`, or exits with an error of one line.
    pub reader: &'static str,
    /// Alternative without the package, the last clause of the error.
    pub otherwise: &'static str,
}

impl Format {
    /// Returns the output of the reader for a file, and its warnings; errors call the file `file`.
    ///
    /// # Errors
    /// If it cannot read the file, or the package or its extra is not installed.
    pub fn read(&self, path: &Path, file: &str) -> Result<(Vec<u8>, Vec<String>), Fault> {
        let Format { name, extra, reader, otherwise } = self;
        let python = interpreter();
        let called = |said: &str| said.replace(&path.display().to_string(), file);
        let fail = |said: &str| {
            // An error of the reader begins with the file; any other means that the package is missing.
            let named = called(said);
            let problem = match named.strip_prefix(file) {
                Some(problem) => problem.trim_start_matches(':').trim_start().to_owned(),
                None => format!(
                    "is {name}, which the Python package reads: pip install 'finger_opt[{extra}]' ({}: \
                     {named}; {PYTHON} names another interpreter); {otherwise}",
                    python.display()
                ),
            };
            Place::file(file).fault(problem)
        };
        let run = command(reader).arg(path).stdin(Stdio::null()).output();
        let found = run.map_err(|error| fail(&error.to_string()))?;
        let said = String::from_utf8_lossy(&found.stderr);
        if found.status.success() {
            let warnings = said.lines().filter(|line| line.starts_with("warning: "));
            return Ok((found.stdout, warnings.map(called).collect()));
        }
        Err(fail(said.lines().last().unwrap_or("nothing")))
    }
}

/// Returns the command that runs Python code.
pub fn command(code: &str) -> Command {
    let mut command = Command::new(interpreter());
    command.args(["-c", &format!("{SAFE}{code}")]).envs([SAFE_PATH]);
    command
}
