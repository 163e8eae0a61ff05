//! Output: standard output, standard error, and what a terminal must not see.

use crate::failure::Failure;
use input::files::visible;
use std::io::{self, Write};

/// Prints to standard output; a reader that has gone away (`| head`) is no error.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(shown(text).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::running(format!("cannot write the output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Text that a terminal may see; a carriage return would overwrite the line.
fn shown(text: &str) -> String {
    visible(text).replace('\r', "\\r")
}

/// A line on standard error. Where that has gone or is full nobody can be told, and no study
/// ends for it.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{}", shown(text));
}
