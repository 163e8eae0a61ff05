//! Calls of the installed Python package in its interpreter.

use input::{InputError, Place};
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::OnceLock;

/// Environment variable with the path of the interpreter.
pub const PYTHON: &str = "FINGER_OPT_PYTHON";
/// Environment variable that excludes the current folder from imports, also in child processes.
const SAFE_PATH: (&str, &str) = ("PYTHONSAFEPATH", "1");
/// Code with the same effect for Python 3.10, which ignores the variable.
const SAFE: &str = "import sys; sys.path[:] = filter(None, sys.path); ";

/// Path of the interpreter that loaded this library; set by the Python package.
pub static OWN: OnceLock<OsString> = OnceLock::new();

/// Returns the interpreter: that of the environment variable, else the one that loaded this library, else `python3`.
pub fn interpreter() -> OsString {
    let own = || OWN.get().cloned().unwrap_or_else(|| "python3".into());
    std::env::var_os(PYTHON).unwrap_or_else(own)
}

/// Code that prints a warning as one line.
const WARNINGS: &str = "import warnings
warnings.formatwarning = lambda message, *rest: f'warning: {message}\\n'";

/// File format that the package reads if one of its extras (optional dependencies) is installed.
pub struct Format {
    /// Name with its article: `a STEP file`.
    pub name: &'static str,
    /// Extra of the package.
    pub extra: &'static str,
    /// Body of a `try` statement, indented by four spaces, that prints the contents of the file `sys.argv[1]`.
    pub reader: &'static str,
    /// What to do without the package, as the last clause of the error.
    pub otherwise: &'static str,
}

impl Format {
    /// Returns the output of the reader for the file at `path`, and its warnings; messages contain `file` for the path.
    ///
    /// # Errors
    /// If it cannot read the file, or the package or its extra is not installed.
    pub fn read(&self, path: &Path, file: &str) -> Result<(Vec<u8>, Vec<String>), InputError> {
        let Format { name, extra, reader, otherwise } = self;
        let python = interpreter();
        let renamed = |text: &str| text.replace(&path.display().to_string(), file);
        let fail = |message: &str| {
            // An error of the reader begins with the file; any other means that the package is missing.
            let named = renamed(message);
            let problem = match named.strip_prefix(file) {
                Some(problem) => problem.trim_start_matches(':').trim_start().to_owned(),
                None => format!(
                    "is {name}, which the Python package reads: pip install './python[{extra}]' in the project's \
                     folder ({}: {named}; {PYTHON} names another interpreter); {otherwise}",
                    python.display()
                ),
            };
            Place::file(file).fault(problem)
        };
        let exit = "except Exception as error:\n    sys.exit(' '.join(str(error).split()))";
        let code = format!("\n{WARNINGS}\ntry:\n    {reader}\n{exit}\n");
        let (output, messages) = output(command(&code).arg(path)).map_err(|error| fail(&error))?;
        let warnings = messages.lines().filter(|line| line.starts_with("warning: "));
        Ok((output, warnings.map(renamed).collect()))
    }
}

/// Runs a command without input and returns its standard output and standard error.
///
/// # Errors
/// If it cannot be started or fails; the error is then the last line of its standard error.
pub fn output(command: &mut Command) -> Result<(Vec<u8>, String), String> {
    let done = command.stdin(Stdio::null()).output().map_err(|error| error.to_string())?;
    let messages = String::from_utf8_lossy(&done.stderr).into_owned();
    match done.status.success() {
        true => Ok((done.stdout, messages)),
        false => Err(messages.lines().last().unwrap_or("no message").to_owned()),
    }
}

/// Returns the command that runs Python code.
pub fn command(code: &str) -> Command {
    let mut command = Command::new(interpreter());
    command.args(["-c", &format!("{SAFE}{code}")]).envs([SAFE_PATH]);
    command
}
