//! Constraints on a design, for example `peak-force<=30`.

use super::Measure;
use crate::Evaluation;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Type of the limit of a constraint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bound {
    /// Upper limit, `<=`.
    AtMost,
    /// Lower limit, `>=`.
    AtLeast,
}

/// Constraint on a measure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Constraint {
    /// Constrained measure.
    pub measure: Measure,
    /// Type of the limit.
    pub bound: Bound,
    /// Limit, in the unit of the measure.
    pub limit: f64,
}

impl Constraint {
    /// Returns the worst value of the measure over the tasks; `None` if it has no value on a task.
    pub fn worst(&self, tasks: &[&Evaluation]) -> Option<f64> {
        let worse = if self.bound == Bound::AtMost { f64::max } else { f64::min };
        let values: Option<Vec<f64>> =
            tasks.iter().map(|evaluation| self.measure.value(evaluation)).collect();
        values?.into_iter().reduce(worse)
    }

    /// Describes the worst value: `31.2 N, violates peak-force<=30`.
    pub fn words(&self, tasks: &[&Evaluation]) -> String {
        let Some(value) = self.worst(tasks) else { return format!("no value for {self}") };
        let verb = if self.violation(value) <= 0.0 { "satisfies" } else { "violates" };
        format!("{}, {verb} {self}", self.measure.show(value))
    }

    /// Returns the excess of a value over the limit as a share of the limit (of 1 if the limit is 0), so that
    /// constraints in different units can be added; 0 or below if feasible.
    pub fn violation(&self, value: f64) -> f64 {
        let limit = self.limit;
        let excess = if self.bound == Bound::AtMost { value - limit } else { limit - value };
        let share = if limit == 0.0 { excess } else { excess / limit.abs() };
        // The share could overflow with a limit near 0.
        share.clamp(f64::MIN, f64::MAX)
    }
}

impl fmt::Display for Constraint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.bound == Bound::AtMost { "<=" } else { ">=" };
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
            return Err(format!(
                "`{text}` is not MEASURE<=NUMBER or MEASURE>=NUMBER; example: 'peak-force<=30'"
            ));
        };
        let (measure, limit) = (name.trim().parse::<Measure>()?, limit.trim());
        match limit.parse() {
            // Violations are divided by the limit, which therefore must not be tiny.
            Ok(limit) if limit == 0.0 || (1e-9..=1e9).contains(&f64::abs(limit)) => {
                Ok(Constraint { measure, bound, limit })
            }
            Ok(limit) if f64::is_finite(limit) => Err(format!(
                "limit {limit:?} is out of range; give 0 or a size between 1e-9 and 1e9"
            )),
            _ => Err(format!(
                "`{limit}` is not a number; give the limit of {} without its unit",
                measure.label()
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::refused;

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
            refused(bad.parse::<Constraint>(), &[word]);
        }
    }
}
