//! The edge between SI (inside) and the units of files, headers and plots.
//!
//! A constant is the SI value of one such unit: `3.0 * MM` reads "3 mm" and is
//! in metres; `x / MM` is the number of millimetres in `x` metres.

/// One millimetre, in metres.
pub const MM: f64 = 1e-3;
/// One newton per millimetre, in N/m.
pub const N_PER_MM: f64 = 1e3;
/// One degree, in radians.
pub const DEG: f64 = std::f64::consts::PI / 180.0;
/// One gigapascal, in pascals.
pub const GPA: f64 = 1e9;
/// One gram, in kilograms.
pub const GRAM: f64 = 1e-3;

/// One percent, as a share.
pub const PERCENT: f64 = 0.01;

/// Writes a length in mm, to a micrometre.
pub fn mm(length: f64) -> String {
    format!("{}", (length / MM * 1e3).round() / 1e3)
}
