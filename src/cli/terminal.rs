//! Output: standard output, standard error, and what a terminal must not see.

use crate::session::Failure;
use input::files::visible;
use serde_json::Value;
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

/// Prints a value as JSON, one line.
pub fn print_json(value: &Value) -> Result<(), Failure> {
    print(&format!("{value}\n"))
}

/// Adds the fields of one JSON object to another.
pub fn merge(fields: &mut Value, more: Value) {
    if let (Value::Object(fields), Value::Object(more)) = (fields, more) {
        fields.extend(more);
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
