//! Logs of attempts: text, or recordings of ROS, which the Python package reads with rosbags.

use crate::python::Format;
use calibration::identify::check::Remark;
use calibration::identify::read;
use input::{InputError, Place};
use std::path::Path;

/// ROS recording, converted to the table of an RTDE recorder.
const BAG: Format = Format {
    name: "a ROS recording",
    extra: "ros",
    reader: "from finger_opt import _bag
    sys.stdout.write(_bag.text(sys.argv[1]))",
    otherwise: "or convert it to CSV",
};
/// Extensions of recordings in a single file; a folder is a recording of ROS 2.
const EXTENSIONS: [&str; 3] = ["mcap", "db3", "bag"];

/// Reads the text of a log, and remarks on what is assumed about a recording.
///
/// # Errors
/// If the log cannot be read, or if it is a recording and the package or its extra `ros` is not installed.
pub fn log_text(path: &Path) -> Result<(String, Vec<Remark>), InputError> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    if !path.is_dir() && !extension.is_some_and(|name| EXTENSIONS.contains(&name)) {
        return Ok((read::text(path)?, Vec::new()));
    }
    let file = path.display().to_string();
    let (found, warnings) = BAG.read(path, &file)?;
    let prefix = format!("warning: {file}: ");
    let remark = |warning: &String| Remark {
        file: file.clone(),
        lines: None,
        text: warning.trim_start_matches(&prefix).to_owned(),
        serious: false,
    };
    let remarks = warnings.iter().map(remark).collect();
    let text =
        String::from_utf8(found).map_err(|error| Place::file(&file).fault(error.to_string()))?;
    Ok((text, remarks))
}
