//! Quantities that several tables of a task file have.

use input::units::MM;
use input::{Check, InputError, shown};

/// Thinnest part and narrowest opening, mm: a thousandth of what a printer prints.
const THINNEST_MM: f64 = 1e-3;

/// Checks a coefficient of friction.
pub fn coefficient(check: Check<'_>, key: &str, value: f64) -> Result<f64, InputError> {
    if (0.0..=5.0).contains(&value) {
        return Ok(value);
    }
    let value = shown(value);
    check.fail(key, format!("is {value}; a coefficient of friction lies in 0 .. 5"))
}

/// Checks a size, mm, and returns it in m.
pub fn size(check: Check<'_>, key: &str, mm: f64) -> Result<f64, InputError> {
    if check.distance(key, check.positive(key, mm)?)? < THINNEST_MM {
        return check.fail(key, format!("is {mm}; it must be {THINNEST_MM} mm or more"));
    }
    Ok(mm * MM)
}

/// Checks the two ends of a part or an opening, mm, and returns them in m.
pub fn span(check: Check<'_>, key: &str, span: [f64; 2]) -> Result<[f64; 2], InputError> {
    let [a, b] = check.each(key, span, Check::distance)?;
    if b - a < THINNEST_MM {
        let problem =
            format!("is [{a}, {b}]; the first must be below the second by {THINNEST_MM} mm");
        return check.fail(key, problem);
    }
    Ok([a * MM, b * MM])
}
