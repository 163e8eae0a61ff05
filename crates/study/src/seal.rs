//! The check that closes each line of a journal.
//!
//! A line is `{contents,"check":"<16 digits>"}` or, with times,
//! `{contents,"check":"<16 digits>","datetime_start":..}`. The check is the
//! beginning of the SHA-256 of all bytes before it.

use super::error::LineError;
use super::record::Timing;
use serde::Serialize;
use sha2::{Digest, Sha256};

const CHECK_KEY: &str = ",\"check\":\"";
const TIME_KEY: &str = ",\"datetime_start\":";

/// A journal without the fields that differ between two runs of the same study.
pub fn strip_times(journal: &str) -> String {
    let content = |line: &str| line.split(TIME_KEY).next().unwrap_or(line).to_owned() + "\n";
    journal.lines().map(content).collect()
}

/// `contents` as one JSON line, closed by its check and, after that, `times`.
pub fn seal(
    contents: &impl Serialize,
    times: Option<&Timing>,
) -> Result<String, serde_json::Error> {
    let mut line = serde_json::to_string(contents)?;
    line.pop();
    let check = check(&line);
    line.push_str(CHECK_KEY);
    line.push_str(&check);
    line.push('"');
    match times {
        Some(times) => {
            line.push(',');
            line.push_str(&serde_json::to_string(times)?[1..]);
        }
        None => line.push('}'),
    }
    line.push('\n');
    Ok(line)
}

/// Whether a line has a check, be it the right one or not.
pub fn is_sealed(line: &str) -> bool {
    line.contains(CHECK_KEY)
}

/// The JSON objects before and after the check of a line, which must fit.
pub fn unseal(line: &str) -> Result<(String, String), LineError> {
    let (content, rest) = line.rsplit_once(CHECK_KEY).ok_or(LineError::Check)?;
    let (found, rest) = rest.split_once('"').ok_or(LineError::Check)?;
    if found != check(content) {
        return Err(LineError::Check);
    }
    let rest = match rest.strip_prefix(',') {
        Some(times) => format!("{{{times}"),
        None if rest == "}" => "{}".to_owned(),
        None => return Err(LineError::Check),
    };
    Ok((format!("{content}}}"), rest))
}

fn check(content: &str) -> String {
    sha256_hex(content.as_bytes())[..16].to_owned()
}

/// SHA-256 in hexadecimal.
pub fn sha256_hex(bytes: &[u8]) -> String {
    format!("{:x}", Sha256::digest(bytes))
}
