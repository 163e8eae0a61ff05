//! Units of files, headers and plots; internally, every quantity is in SI units.
//!
//! A constant is the SI value of one such unit: `3.0 * MM` reads "3 mm" and is
//! in metres; `x / MM` is the number of millimetres in `x` metres.

use serde::{Deserialize, Deserializer};

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

/// One percent, as a fraction.
pub const PERCENT: f64 = 0.01;

/// Suffixes of names and their units in labels, which omit others. A suffix precedes its own endings: `_n_per_mm`, then
/// `_mm`.
const SUFFIXES: [(&str, &str); 11] = [
    ("_gpa", " GPa"),
    ("_percent", " %"),
    ("_deg", "°"),
    ("_mm_per_s", " mm/s"),
    ("_n_per_mm", " N/mm"),
    ("_nm_per_rad", " N m/rad"),
    ("_mm", " mm"),
    ("_n", " N"),
    ("_kg", " kg"),
    ("_g", " g"),
    ("_s", " s"),
];

/// Splits the unit, as in labels, off the end of a name.
pub fn without_unit(name: &str) -> (&str, &'static str) {
    let split = |(end, unit): &(&str, &'static str)| Some((name.strip_suffix(end)?, *unit));
    SUFFIXES.iter().find_map(split).unwrap_or((name, ""))
}

/// Number, or array, `Vec` or `Option` of numbers, that a factor converts to another unit.
pub trait Quantity<'de>: Deserialize<'de> {
    /// Multiplies all numbers by a factor.
    fn times(self, factor: f64) -> Self;
}

impl Quantity<'_> for f64 {
    fn times(self, factor: f64) -> Self {
        self * factor
    }
}

impl<'de, T: Quantity<'de>, const N: usize> Quantity<'de> for [T; N]
where
    [T; N]: Deserialize<'de>,
{
    fn times(self, factor: f64) -> Self {
        self.map(|item| item.times(factor))
    }
}

impl<'de, T: Quantity<'de>> Quantity<'de> for Vec<T> {
    fn times(self, factor: f64) -> Self {
        self.into_iter().map(|item| item.times(factor)).collect()
    }
}

impl<'de, T: Quantity<'de>> Quantity<'de> for Option<T> {
    fn times(self, factor: f64) -> Self {
        self.map(|item| item.times(factor))
    }
}

/// Deserializers that convert to SI units, for `#[serde(deserialize_with)]`.
#[expect(clippy::missing_errors_doc, reason = "that of the deserializer")]
pub mod read {
    use super::{DEG, Deserializer, GPA, GRAM, MM, N_PER_MM, PERCENT, Quantity};

    /// Reads mm as m.
    pub fn mm<'de, T: Quantity<'de>, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
        Ok(T::deserialize(from)?.times(MM))
    }

    /// Reads degrees as rad.
    pub fn deg<'de, T: Quantity<'de>, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
        Ok(T::deserialize(from)?.times(DEG))
    }

    /// Reads grams as kg.
    pub fn gram<'de, T: Quantity<'de>, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
        Ok(T::deserialize(from)?.times(GRAM))
    }

    /// Reads GPa as Pa.
    pub fn gpa<'de, T: Quantity<'de>, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
        Ok(T::deserialize(from)?.times(GPA))
    }

    /// Reads N/mm as N/m.
    pub fn n_per_mm<'de, T: Quantity<'de>, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
        Ok(T::deserialize(from)?.times(N_PER_MM))
    }

    /// Reads percent as a fraction.
    pub fn percent<'de, T: Quantity<'de>, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
        Ok(T::deserialize(from)?.times(PERCENT))
    }
}

/// Formats a length, given in m, as the number of millimetres, rounded to a micrometre.
pub fn mm(length: f64) -> String {
    format!("{}", (length / MM * 1e3).round() / 1e3)
}
