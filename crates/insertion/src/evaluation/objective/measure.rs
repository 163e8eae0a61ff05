//! Measures: quantities of an evaluation that can be optimized or constrained, and their units.

use crate::{Evaluation, Outcome};
use ask_tell::gp::DEFAULT_NOISE_FLOOR;
use std::fmt;
use std::str::FromStr;

/// Quantity of an evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Width of the tolerance window, mm.
    Range,
    /// Twice the smaller side of the window about the nominal start, mm: for errors of either sign.
    CentredRange,
    /// Share of the trials under sampled errors that insert, 0 to 1.
    SuccessRate,
    /// Statistic of the ranges under sampled errors, mm.
    RobustRange,
    /// Largest contact force between plug and socket over the inserted trials, N.
    PeakForce,
    /// Largest slip of the part in the grasp over the inserted trials, mm.
    Slip,
}

/// Measure, name, unit, unit in keys and number of decimals, in the order of the enum and of messages.
const MEASURES: [(Measure, &str, &str, &str, usize); 6] = [
    (Measure::Range, "range", "mm", "mm", 1),
    (Measure::CentredRange, "centred-range", "mm", "mm", 1),
    (Measure::SuccessRate, "success-rate", "", "share", 3),
    (Measure::RobustRange, "robust-range", "mm", "mm", 2),
    (Measure::PeakForce, "peak-force", "N", "n", 1),
    (Measure::Slip, "slip", "mm", "mm", 2),
];

impl Measure {
    /// Returns all measures.
    pub fn all() -> [Measure; 6] {
        MEASURES.map(|(measure, ..)| measure)
    }

    /// Returns the name on the command line and in study files.
    pub fn name(self) -> &'static str {
        MEASURES[self as usize].1
    }

    /// Returns the unit for text and axes; empty for a share.
    pub fn unit(self) -> &'static str {
        MEASURES[self as usize].2
    }

    /// Returns the unit as the suffix of a key: `mm`, `n` or `share`.
    pub fn key(self) -> &'static str {
        MEASURES[self as usize].3
    }

    /// Returns 1 to maximize, -1 to minimize.
    pub fn sense(self) -> f64 {
        if matches!(self, Measure::PeakForce | Measure::Slip) { -1.0 } else { 1.0 }
    }

    /// Returns whether the measure is taken under sampled errors.
    pub fn needs_draws(self) -> bool {
        matches!(self, Measure::SuccessRate | Measure::RobustRange)
    }

    /// Returns the standard deviation of the rounding error, in the unit of the measure: windows have a grid of 0.1 mm,
    /// success rates are multiples of `1 / trials`; forces and slips are not rounded.
    pub fn rounding(self, trials: u32) -> f64 {
        match self {
            Measure::PeakForce | Measure::Slip => 0.0,
            Measure::Range | Measure::CentredRange | Measure::RobustRange => DEFAULT_NOISE_FLOOR,
            Measure::SuccessRate => 1.0 / f64::from(trials) / 12f64.sqrt(),
        }
    }

    /// Returns the value in the unit of the measure; `None` if it was not measured. If the nominal start fails, the
    /// range is 0 and there is neither force nor slip; if it diverges, there is no range either. A diverged trial ends
    /// a window like a failed one. The success rate of a lost race is its upper bound.
    pub fn value(self, evaluation: &Evaluation) -> Option<f64> {
        let window = &evaluation.window;
        let value = match (window.nominal, self) {
            (_, Measure::SuccessRate) => evaluation.success.as_ref()?.max_rate(),
            (_, Measure::RobustRange) => evaluation.robust.as_ref()?.value_mm,
            (Outcome::Diverged, _) => None,
            (Outcome::Inserted, Measure::CentredRange) => {
                Some(2.0 * window.positive_mm().min(-window.negative_mm()))
            }
            (Outcome::Inserted, Measure::PeakForce) => Some(evaluation.peak_force_n),
            (Outcome::Inserted, Measure::Slip) => Some(evaluation.slip_mm),
            (Outcome::Inserted, Measure::Range) => Some(window.range_mm()),
            (Outcome::Failed(_), Measure::PeakForce | Measure::Slip) => None,
            (Outcome::Failed(_), Measure::Range | Measure::CentredRange) => Some(0.0),
        };
        value.filter(|value| value.is_finite())
    }

    /// Returns a value with its unit.
    pub fn show(self, value: f64) -> String {
        let (_, _, unit, _, decimals) = MEASURES[self as usize];
        format!("{value:.decimals$} {unit}").trim_end().to_owned()
    }

    /// Returns name and unit, for an axis or a heading: `peak-force (N)`.
    pub fn label(self) -> String {
        match self {
            Measure::SuccessRate => "success-rate (0 to 1)".to_owned(),
            _ => format!("{self} ({})", self.unit()),
        }
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Measure {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        Measure::all().into_iter().find(|measure| measure.name() == name).ok_or_else(|| {
            let names = Measure::all().map(Measure::name).join(", ");
            format!("unknown measure `{name}`; available: {names}")
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::evaluation::tests::{ranges, success};
    use crate::evaluation::{RobustRange, Window};
    use crate::outcome::FailureClass;

    pub fn evaluation(nominal: Outcome, end_positive: Outcome) -> Evaluation {
        let end_negative = Some(Outcome::Failed(FailureClass::Jammed));
        let window = Window {
            nominal,
            negative_steps: -33,
            positive_steps: 14,
            end_negative,
            end_positive: Some(end_positive),
        };
        Evaluation { peak_force_n: 5.0, slip_mm: 0.1, ..Evaluation::of(window, [0.0; 2]) }
    }

    #[test]
    fn values_of_a_window() {
        let missed = Outcome::Failed(FailureClass::PlugMissed);
        let good = evaluation(Outcome::Inserted, missed);
        let bad = evaluation(missed, missed);
        for (measure, of_good, of_bad) in [
            (Measure::Range, Some(4.7), Some(0.0)),
            (Measure::CentredRange, Some(2.8), Some(0.0)),
            (Measure::PeakForce, Some(5.0), None),
            (Measure::Slip, Some(0.1), None),
            (Measure::SuccessRate, None, None),
            (Measure::RobustRange, None, None),
        ] {
            assert_eq!((measure.value(&good), measure.value(&bad)), (of_good, of_bad), "{measure}");
        }
        let diverged = |nominal| Measure::Range.value(&evaluation(nominal, Outcome::Diverged));
        assert_eq!([Outcome::Diverged, Outcome::Inserted].map(diverged), [None, Some(4.7)]);
    }

    #[test]
    fn drawn_measures_do_not_depend_on_the_nominal_start() {
        let jammed = Outcome::Failed(FailureClass::Jammed);
        let drawn = Evaluation {
            success: Some(success(3, 1)),
            robust: Some(RobustRange { value_mm: Some(0.6), ..ranges(vec![1.0, 3.0]) }),
            ..evaluation(jammed, jammed)
        };
        assert_eq!(Measure::SuccessRate.value(&drawn), Some(0.75));
        assert_eq!(Measure::RobustRange.value(&drawn), Some(0.6));
    }
}
