//! Lines of JSON with a checksum: of journals, cached evaluations and work for other processes.
//!
//! A line is `{contents,"check":"<16 digits>"}` or, with times,
//! `{contents,"check":"<16 digits>","datetime_start":..}`. The checksum is the beginning of the SHA-256 of
//! all bytes before it.

use super::Timing;
use super::error::LineError;
pub use insertion::task::parts_file::sha256 as sha256_hex;
use serde::Serialize;

/// Text before the checksum of a line.
pub(super) const CHECK_KEY: &str = ",\"check\":\"";

/// Returns `contents` as a line of JSON with its checksum, followed by `times`.
pub fn seal(
    contents: &impl Serialize,
    times: Option<&Timing>,
) -> Result<String, serde_json::Error> {
    let mut line = serde_json::to_string(contents)?;
    line.pop();
    let check = checksum(&line);
    let rest = match times {
        Some(times) => format!(",{}", &serde_json::to_string(times)?[1..]),
        None => "}".to_owned(),
    };
    Ok(format!("{line}{CHECK_KEY}{check}\"{rest}\n"))
}

/// Returns the JSON objects before and after the checksum of a line.
///
/// # Errors
/// If the checksum is missing or wrong.
pub fn unseal(line: &str) -> Result<(String, String), LineError> {
    let (content, rest) = line.rsplit_once(CHECK_KEY).ok_or(LineError::Check)?;
    let (found, rest) = rest.split_once('"').ok_or(LineError::Check)?;
    if found != checksum(content) {
        return Err(LineError::Check);
    }
    let rest = match rest.strip_prefix(',') {
        Some(times) => format!("{{{times}"),
        None if rest == "}" => "{}".to_owned(),
        None => return Err(LineError::Check),
    };
    Ok((format!("{content}}}"), rest))
}

fn checksum(content: &str) -> String {
    sha256_hex(content.as_bytes())[..16].to_owned()
}
