//! Names of the files of recordings, and labels of their starts.

use std::path::{Path, PathBuf};

/// Parses the name of a file into which a trial can be recorded.
pub(crate) fn recordable(text: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(text);
    match &*extension(&file) {
        "html" => Ok(file),
        _ => Err("the name must end with .html; --log writes force and pose as CSV".into()),
    }
}

/// Returns the extension of a file, in lower case.
pub(crate) fn extension(file: &Path) -> String {
    file.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Returns the label of a start shifted along y.
pub(crate) fn start_label(offset_mm: f64) -> String {
    match offset_mm == 0.0 {
        true => "nominal start".to_owned(),
        false => format!("start shifted by {offset_mm:+.1} mm"),
    }
}
