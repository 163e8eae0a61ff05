//! Time stamps as Optuna reads them: UTC without a zone, to the microsecond.

use jiff::Timestamp;
use jiff::civil::DateTime;
use std::time::{SystemTime, UNIX_EPOCH};

/// Now, `YYYY-MM-DDTHH:MM:SS.ffffff` in UTC.
pub fn now() -> String {
    // A clock that is wrong by thousands of years is no reason to lose a measurement.
    let clock = SystemTime::now();
    let last = if clock > UNIX_EPOCH { Timestamp::MAX } else { Timestamp::UNIX_EPOCH };
    format(Timestamp::try_from(clock).unwrap_or(last).max(Timestamp::UNIX_EPOCH))
}

fn format(moment: Timestamp) -> String {
    moment.strftime("%Y-%m-%dT%H:%M:%S.%6f").to_string()
}

/// Whether `text` is a time stamp of that form.
pub fn is_timestamp(text: &str) -> bool {
    let read = DateTime::strptime("%Y-%m-%dT%H:%M:%S.%6f", text);
    text.len() == "0000-00-00T00:00:00.000000".len() && read.is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moment_is_written_with_all_its_digits_and_read_again() {
        assert!(is_timestamp(&format(Timestamp::MAX)));
        for (microseconds, text) in [
            (0, "1970-01-01T00:00:00.000000"),
            (1_709_251_199_000_070, "2024-02-29T23:59:59.000070"),
        ] {
            assert_eq!(format(Timestamp::from_microsecond(microseconds).unwrap()), text);
            assert!(is_timestamp(text));
        }
        for wrong in
            ["2024-02-29 23:59:59.000000", "2023-02-29T23:59:59.000000", "2024-02-29T23:59:59.0"]
        {
            assert!(!is_timestamp(wrong), "{wrong}");
        }
    }
}
