//! Logs of attempts: text, or recordings of ROS, which the Python package reads by rosbags.

use crate::python::Format;
use calibration::identify::read;
use input::{Fault, Place};
use std::path::Path;

/// Read as the table of an RTDE recorder.
const BAG: Format = Format {
    name: "a ROS recording",
    extra: "ros",
    reader: "
try:
    from finger_opt import _bag
    sys.stdout.write(_bag.text(sys.argv[1]))
except Exception as error:
    sys.exit(' '.join(str(error).split()))
",
    otherwise: "or convert it to CSV",
};
/// Endings of single files; a folder is the recording of ROS 2.
const ENDINGS: [&str; 3] = ["mcap", "db3", "bag"];

/// Returns the text of a log.
///
/// # Errors
/// If it cannot be read, or is a recording and the package or its extra `ros` is not installed.
pub fn log_text(path: &Path) -> Result<String, Fault> {
    let ending = path.extension().and_then(|ending| ending.to_str());
    if !path.is_dir() && !ending.is_some_and(|ending| ENDINGS.contains(&ending)) {
        return read::text(path);
    }
    let file = path.display().to_string();
    let (found, _) = BAG.read(path, &file)?;
    String::from_utf8(found).map_err(|error| Place::file(file).fault(error.to_string()))
}
