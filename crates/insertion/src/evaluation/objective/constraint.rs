//! Constraints on a design, for example `peak-force<=30`.

use super::Measure;
use crate::evaluation::Evaluation;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Side of the limit that is feasible.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bound {
    /// `<=`, an upper limit.
    AtMost,
    /// `>=`, a lower limit.
    AtLeast,
}

/// Constraint on a measure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Constraint {
    /// Constrained measure.
    pub measure: Measure,
    /// Feasible side of the limit.
    pub bound: Bound,
    /// The limit, in the measure's unit.
    pub limit: f64,
}

impl Constraint {
    /// Returns the measure on the task where it is worst; `None` if it has no value on one of them.
    pub fn worst(&self, tasks: &[&Evaluation]) -> Option<f64> {
        let worse: fn(f64, f64) -> f64 = match self.bound {
            Bound::AtMost => f64::max,
            Bound::AtLeast => f64::min,
        };
        let values: Option<Vec<f64>> =
            tasks.iter().map(|evaluation| self.measure.value(evaluation)).collect();
        values?.into_iter().reduce(worse)
    }

    /// Returns the worst value in words: `31.2 N, violates peak-force<=30`.
    pub fn words(&self, tasks: &[&Evaluation]) -> String {
        match self.worst(tasks) {
            None => format!("no value for {self}"),
            Some(value) => {
                let verb = if self.violation(value) <= 0.0 { "keeps" } else { "violates" };
                format!("{}, {verb} {self}", self.measure.show(value))
            }
        }
    }

    /// Returns the violation by a value as a share of the limit (of 1 if that is 0), so that constraints in
    /// different units can be added; 0 or below if feasible.
    pub fn violation(&self, value: f64) -> f64 {
        let beyond = match self.bound {
            Bound::AtMost => value - self.limit,
            Bound::AtLeast => self.limit - value,
        };
        let share = if self.limit == 0.0 { beyond } else { beyond / self.limit.abs() };
        // The share could overflow with a limit near 0.
        share.clamp(f64::MIN, f64::MAX)
    }
}

impl fmt::Display for Constraint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = match self.bound {
            Bound::AtMost => "<=",
            Bound::AtLeast => ">=",
        };
        f.pad(&format!("{}{sign}{}", self.measure, self.limit))
    }
}

impl FromStr for Constraint {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let parts = [("<=", Bound::AtMost), (">=", Bound::AtLeast)]
            .into_iter()
            .find_map(|(sign, bound)| Some((text.split_once(sign)?, bound)));
        let Some(((name, limit), bound)) = parts else {
            return Err("a constraint is MEASURE<=NUMBER or MEASURE>=NUMBER, as in \
                        'peak-force<=30'"
                .to_owned());
        };
        let measure: Measure = name.trim().parse()?;
        match limit.trim().parse() {
            // Violations are shares of the limit.
            Ok(limit) if limit == 0.0 || (1e-9..=1e9).contains(&f64::abs(limit)) => {
                Ok(Constraint { measure, bound, limit })
            }
            Ok(limit) if f64::is_finite(limit) => {
                Err("a limit is 0 or of a size between 1e-9 and 1e9".to_owned())
            }
            _ => Err(format!(
                "`{}` is not a number; give the limit of {} without its unit",
                limit.trim(),
                measure.label()
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn violations_are_shares_of_the_limit() {
        let of = |text: &str, value| text.parse::<Constraint>().unwrap().violation(value);
        assert_eq!(of("peak-force<=30", 36.0), 0.2);
        assert_eq!(of("peak-force <= 30", 30.0), 0.0);
        assert_eq!(of("success-rate>=0.5", 0.75), -0.5);
        assert_eq!(of("slip<=0", 0.25), 0.25);
        assert_eq!(of("robust-range>=-2", -3.0), 0.5);
    }

    #[test]
    fn constraints_survive_a_round_trip_and_errors_name_what_is_accepted() {
        for text in ["peak-force<=30", "success-rate>=0.95"] {
            assert_eq!(text.parse::<Constraint>().unwrap().to_string(), text);
        }
        for (bad, word) in [
            ("peak-force", "MEASURE>=NUMBER"),
            ("slip<=inf", "not a number"),
            ("slip<=1e300", "between 1e-9 and 1e9"),
            ("slip<=1e-300", "between 1e-9 and 1e9"),
            ("slip<=", "not a number"),
        ] {
            let error = bad.parse::<Constraint>().unwrap_err();
            assert!(error.contains(word), "{error}");
        }
    }
}
