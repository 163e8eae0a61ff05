//! Results of the checks as text.

use super::{CheckRow, Tolerance};
use report::text_table;

/// Returns an aligned table at most 80 columns wide, and the verdict.
pub fn table(rows: &[CheckRow]) -> String {
    let cells = rows.iter().map(|row| {
        let (error, allowed) = match row.tolerance {
            Tolerance::Relative(share) => (percent(row.error()), percent(share)),
            Tolerance::Absolute(error) => (number(row.error()), number(error)),
        };
        let within = row.error().abs() <= row.tolerance.largest();
        let verdict = match (row.passed, within) {
            (false, _) => "FAIL",
            (true, true) => "ok",
            (true, false) => "halves",
        };
        let [expected, measured] = [row.expected, row.measured].map(number);
        let unit = row.unit.to_owned();
        let (check, quantity) = (row.check.to_owned(), row.quantity.clone());
        [check, quantity, expected, measured, unit, error, allowed, verdict.to_owned()]
    });
    let head = ["", "quantity", "expected", "measured", "unit", "error", "allowed", ""];
    let failed = rows.iter().filter(|row| !row.passed).count();
    text_table(2, head, cells)
        + &match failed {
            0 => format!("pass: all {} checks\n", rows.len()),
            failed => format!("fail: {failed} of {} checks\n", rows.len()),
        }
}

fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if size < 1e-3 => format!("{value:.1e}"),
        size if size < 10.0 => format!("{value:.5}"),
        size if size < 1e4 => format!("{value:.3}"),
        _ => format!("{value:.2e}"),
    }
}

fn percent(share: f64) -> String {
    match (100.0 * share).abs() {
        0.0 => "0 %".into(),
        size if size < 0.01 => format!("{:.0e} %", 100.0 * share),
        _ => format!("{:.2} %", 100.0 * share),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact::Diverged;

    const LONG: &str = "bad, and named by more words than its column has room for";

    fn rows() -> Vec<CheckRow> {
        let row = |name: &str, expected, measured: Result<f64, Diverged>, unit| {
            CheckRow::new("T1", name, expected, measured, unit, Tolerance::Relative(0.01))
        };
        vec![
            row("good", 2.0, Ok(2.01), "mm"),
            row(LONG, 7_175_000.0, Ok(-8e6), "rad/Nm"),
            row("diverged", 2.0, Err(Diverged), "mm"),
        ]
    }

    #[test]
    fn table_fits_a_terminal_and_names_the_failures() {
        assert_eq!(rows().iter().map(|row| row.passed).collect::<Vec<_>>(), [true, false, false]);
        let text = table(&rows());
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        assert!(text.contains("quantity") && text.contains("unit"), "{text}");
        assert_eq!(text.matches("FAIL").count(), 2, "{text}");
        assert!(text.ends_with("\nfail: 2 of 3 checks\n"), "{text}");
        // The long name is whole, in several lines.
        assert!(LONG.split(' ').all(|word| text.contains(word)), "{text}");
    }
}
