//! STEP files, which the Python package reads by Open Cascade.

use crate::failure::Failure;
use crate::python::{PYTHON, command, interpreter};
use connector::mesh::{Body, read};
use std::path::Path;
use std::process::Stdio;

/// Writes the bodies as OBJ in mm, or says in one line what is wrong.
const READER: &str = "
try:
    from finger_opt import _step
    sys.stdout.write(_step.obj(_step.read(sys.argv[1], 0.01)))
except Exception as error:
    sys.exit(' '.join(str(error).split()))
";

/// Returns the bodies of a STEP file, mm, meshed within 0.01 mm.
///
/// # Errors
/// If the file is no STEP file, or the Python package or its extra `step` is not installed.
pub fn bodies(path: &Path, file: &str) -> Result<Vec<Body>, Failure> {
    let python = interpreter();
    let fail = |said: &str| {
        // Names the file itself, unless the package is missing.
        let named = said.replace(&path.display().to_string(), file);
        let problem = match named.strip_prefix(file) {
            Some(problem) => problem.trim_start_matches(':').trim_start().to_owned(),
            None => format!(
                "is a STEP file, which the Python package reads: pip install 'finger_opt[step]' ({} says: {named}; \
                 {PYTHON} names another interpreter); or export STL",
                python.display()
            ),
        };
        Failure::in_file(file, problem)
    };
    let run = command(READER).arg(path).stdin(Stdio::null()).output();
    let found = run.map_err(|error| fail(&error.to_string()))?;
    if !found.status.success() {
        let said = String::from_utf8_lossy(&found.stderr);
        return Err(fail(said.lines().last().unwrap_or("nothing")));
    }
    read(&found.stdout, &format!("{file}.obj")).map_err(Failure::input)
}
