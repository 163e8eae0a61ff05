//! What an optimizer is to make large.

use crate::evaluation::{Evaluation, Outcome};
use std::fmt;
use std::str::FromStr;

/// An objective; larger is better, in mm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    /// Width of the tolerance window.
    Range,
    /// Twice the smaller side of the window: for a robot that errs both ways.
    CentredRange,
}

impl Objective {
    /// All objectives.
    pub const ALL: [Objective; 2] = [Objective::Range, Objective::CentredRange];

    /// Its name on the command line and in study files.
    pub fn name(self) -> &'static str {
        match self {
            Objective::Range => "range",
            Objective::CentredRange => "centred-range",
        }
    }

    /// Its value, mm; 0 if the nominal start fails, `None` if it diverges. A
    /// window that a divergence ends counts as far as it was seen to insert.
    pub fn value(self, evaluation: &Evaluation) -> Option<f64> {
        let window = &evaluation.window;
        match (window.nominal, self) {
            (Outcome::Diverged, _) => None,
            (Outcome::Failed(_), _) => Some(0.0),
            (Outcome::Inserted, Objective::Range) => Some(window.range_mm()),
            (Outcome::Inserted, Objective::CentredRange) => {
                Some(2.0 * window.positive_mm().min(-window.negative_mm()))
            }
        }
    }
}

impl fmt::Display for Objective {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Objective {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        let names = Objective::ALL.map(Objective::name).join(", ");
        Objective::ALL
            .into_iter()
            .find(|objective| objective.name() == name)
            .ok_or_else(|| format!("no objective is called `{name}`; there are {names}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::{FailureClass, Window};

    fn evaluation(nominal: Outcome, end_positive: Outcome) -> Evaluation {
        let end_negative = Some(Outcome::Failed(FailureClass::Jammed));
        let window = Window {
            nominal,
            negative_steps: -33,
            positive_steps: 14,
            end_negative,
            end_positive: Some(end_positive),
        };
        Evaluation {
            window,
            failure_counts: [0; 4],
            diverged: 0,
            trials: 49,
            peak_force_n: 5.0,
            slip_mm: 0.1,
            simulated_s: 49.0,
            success: None,
            robust: None,
        }
    }

    #[test]
    fn values_of_a_window() {
        let missed = Outcome::Failed(FailureClass::PlugMissed);
        let good = evaluation(Outcome::Inserted, missed);
        assert_eq!(Objective::Range.value(&good), Some(4.7));
        assert_eq!(Objective::CentredRange.value(&good), Some(2.8));
        assert_eq!(Objective::CentredRange.value(&evaluation(missed, missed)), Some(0.0));
    }

    #[test]
    fn a_divergence_at_the_nominal_start_hides_the_value() {
        let value = |nominal| Objective::Range.value(&evaluation(nominal, Outcome::Diverged));
        assert_eq!(value(Outcome::Diverged), None);
        assert_eq!(value(Outcome::Inserted), Some(4.7));
    }

    #[test]
    fn names_read_back_and_others_are_answered_with_the_names() {
        for objective in Objective::ALL {
            assert_eq!(objective.to_string().parse(), Ok(objective));
        }
        let error = "rnage".parse::<Objective>().unwrap_err();
        assert!(error.contains("range, centred-range"), "{error}");
    }
}
