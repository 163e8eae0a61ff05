//! Results of the checks as text.

use super::{CheckRow, Tolerance};

/// Width of the quantities; the rest of a longer one goes to the next line.
const QUANTITY: usize = 29;

/// Aligned table at most 80 columns wide, and the verdict.
pub fn table(rows: &[CheckRow]) -> String {
    let mut text = format!(
        "{:<4}{:<QUANTITY$}{:>9}{:>9} {:<6}{:>9} {:<7}\n",
        "", "quantity", "expected", "measured", "unit", "error", "allowed"
    );
    for row in rows {
        let (error, allowed) = match row.tolerance {
            Tolerance::Relative(share) => (percent(row.error()), percent(share)),
            Tolerance::Absolute(error) => (number(row.error()), number(error)),
        };
        let verdict = if row.passed { "ok" } else { "FAIL" };
        let (quantity, rest) = broken(&row.quantity);
        text += &format!(
            "{:<4}{quantity:<QUANTITY$}{:>9}{:>9} {:<6}{error:>9} {allowed:<8}{verdict}\n",
            row.check,
            number(row.expected),
            number(row.measured),
            row.unit,
        );
        if !rest.is_empty() {
            text += &format!("      {rest}\n");
        }
    }
    let failed = rows.iter().filter(|row| !row.passed).count();
    text + &match failed {
        0 => format!("pass: all {} checks\n", rows.len()),
        failed => format!("fail: {failed} of {} checks\n", rows.len()),
    }
}

/// Quantity split at the end of a word where its column ends.
fn broken(quantity: &str) -> (&str, &str) {
    match quantity.char_indices().nth(QUANTITY) {
        None => (quantity, ""),
        Some((end, _)) => match quantity[..end].rfind(' ') {
            Some(space) => (&quantity[..space], &quantity[space + 1..]),
            None => quantity.split_at(end),
        },
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

    fn rows() -> Vec<CheckRow> {
        let long = "bad, and named by more words than its column has room for";
        let row = |name: &str, expected, measured: Result<f64, Diverged>, unit| {
            CheckRow::new("T1", name, expected, measured, unit, Tolerance::Relative(0.01))
        };
        vec![
            row("good", 2.0, Ok(2.01), "mm"),
            row(long, 7_175_000.0, Ok(-8e6), "rad/Nm"),
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
        // The long name is whole, in two lines.
        assert!(text.contains("by more words ") && text.contains("\n      than its"), "{text}");
    }
}
