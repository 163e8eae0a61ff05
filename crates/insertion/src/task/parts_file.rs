//! Parts file: the parts of a task in a separate file, so that many parts do not hide the rest of the task.

use input::files::{LARGEST_INPUT, read_text};
use input::shipped::Source;
use input::{Check, InputError};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::path::Path;
use toml::Table;

/// Separator between the text of a task and its appended parts.
const APPENDED: &str = "\n# Parts of the file named under [parts]:\n";

/// File of the parts, relative to the task file, and the hash of its text.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartsFile {
    /// Name of the file.
    pub file: String,
    /// SHA-256 of the text of the file, hexadecimal.
    pub sha256: String,
}

/// Returns the SHA-256 of a text or of bytes, hexadecimal.
pub fn sha256(bytes: impl AsRef<[u8]>) -> String {
    format!("{:x}", Sha256::digest(bytes))
}

/// Returns a task file with the text of its parts file appended, if it names one. The combined text is complete; a
/// study copies it.
///
/// # Errors
/// If the parts file cannot be read, or has changed.
pub fn with_parts(source: Source) -> Result<Source, InputError> {
    if !source.text.contains("[parts]") || source.text.contains(APPENDED) {
        return Ok(source);
    }
    // The parser of the task reports invalid TOML.
    let Ok(mut table) = source.text.parse::<Table>() else { return Ok(source) };
    let reference = table.remove("parts").and_then(|parts| parts.try_into::<PartsFile>().ok());
    let Some(PartsFile { file, sha256: expected }) = reference else { return Ok(source) };
    let check = Check { file: &source.file };
    let path = Path::new(&source.file).parent().unwrap_or(Path::new("")).join(&file);
    let parts = read_text(&path, LARGEST_INPUT)
        .or_else(|error| check.fail("parts.file", format!("cannot read {file}: {error}")))?;
    if sha256(&parts) != expected {
        let problem =
            format!("{file} has changed since the task was written; import the task again");
        return check.fail("parts.sha256", problem);
    }
    Ok(Source { text: joined(&source.text, &parts), file: source.file })
}

/// Returns the text of a task file with the text of its parts file appended.
pub fn joined(task: &str, parts: &str) -> String {
    format!("{task}{APPENDED}{parts}")
}

/// Returns the text of a task file without appended parts.
pub fn without_parts(text: &str) -> &str {
    text.split(APPENDED).next().unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::{refused, task_file};

    /// A shipped task whose socket is in a parts file is the same task; a changed parts file is refused.
    #[test]
    fn parts_beside_the_task_are_read_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let usb = task_file("usb");
        let (from, to) =
            (usb.text.find("[[socket.part]]").unwrap(), usb.text.find("[grip]").unwrap());
        let parts = &usb.text[from..to];
        let named = format!("[parts]\nfile = \"usb.parts.toml\"\nsha256 = \"{}\"\n", sha256(parts));
        let text = format!("{}{}{named}", &usb.text[..from], &usb.text[to..]);
        let file = folder.path().join("usb.toml").display().to_string();
        let source = || Source { file: file.clone(), text: text.clone() };
        refused(with_parts(source()), &["usb.parts.toml"]);
        std::fs::write(folder.path().join("usb.parts.toml"), parts).unwrap();
        let read = with_parts(source()).unwrap();
        let [found, expected] =
            [&read.text, usb.text].map(|text| super::super::Task::parse(text, "usb").unwrap());
        assert_eq!(found, expected);
        assert_eq!(without_parts(&read.text), text);
        assert_eq!(with_parts(read.clone()).unwrap(), read);
        std::fs::write(folder.path().join("usb.parts.toml"), "").unwrap();
        refused(with_parts(source()), &["has changed"]);
    }
}
