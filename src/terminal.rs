//! Standard output and standard error, without control characters.

use crate::failure::Failure;
use input::files::visible;
use std::io::{self, Write};

/// Prints to standard output; a closed pipe (`| head`) is not an error.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(shown(text).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::running(format!("cannot write the output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Returns text with control characters escaped; a carriage return would overwrite the line.
fn shown(text: &str) -> String {
    visible(text).replace('\r', "\\r")
}

/// Writes a line on standard error; a failure is ignored, so that it does not end a study.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{}", shown(text));
}
