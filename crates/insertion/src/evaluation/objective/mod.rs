//! Objectives and constraints over one or several tasks.

mod aggregate;
mod constraint;
mod measure;

pub use aggregate::{Aggregate, AggregateKind};
pub use constraint::{Bound, Constraint};
pub use measure::Measure;

use crate::evaluation::OFFSET_STEP_MM;
use crate::{Evaluation, Outcome};
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::fmt;
use std::str::FromStr;

/// Implements the conversions of types that study files store in the syntax of the command line.
macro_rules! stored_as_text {
    ($($stored:ty),*) => {$(
        impl From<$stored> for String {
            fn from(value: $stored) -> String {
                value.to_string()
            }
        }

        impl TryFrom<String> for $stored {
            type Error = String;
            fn try_from(text: String) -> Result<Self, String> {
                text.parse()
            }
        }
    )*};
}

stored_as_text!(Aggregate, Constraint, Objectives);

/// Largest number of objectives: a Pareto front of more objectives is too large to choose from.
const MAX_OBJECTIVES: usize = 3;

/// One to three different measures to be optimized, in the order given.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Objectives(Vec<Measure>);

impl Objectives {
    /// Returns a single objective.
    pub fn of(measure: Measure) -> Self {
        Objectives(vec![measure])
    }

    /// Returns all objectives, at least one.
    pub fn measures(&self) -> &[Measure] {
        &self.0
    }

    /// Returns the first objective, which plots show.
    pub fn first(&self) -> Measure {
        self.0[0]
    }

    /// Returns the only objective; `None` if there are several.
    pub fn single(&self) -> Option<Measure> {
        (self.0.len() == 1).then_some(self.0[0])
    }

    /// Returns the key of each objective in tables and JSON: `objective_mm`; `objective_1_mm`, `objective_2_n`.
    pub fn keys(&self) -> Vec<String> {
        if let Some(measure) = self.single() {
            return vec![format!("objective_{}", measure.key())];
        }
        let numbered = (1..).zip(&self.0);
        numbered.map(|(n, measure)| format!("objective_{n}_{}", measure.key())).collect()
    }

    /// Formats values with names and units: `range 4.7 mm, peak-force 5.0 N`.
    pub fn show(&self, values: &[f64]) -> String {
        let shown = self.0.iter().zip(values);
        let words: Vec<String> =
            shown.map(|(measure, &value)| format!("{measure} {}", measure.show(value))).collect();
        words.join(", ")
    }
}

impl fmt::Display for Objectives {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0.iter().map(|measure| measure.name()).collect::<Vec<_>>().join(","))
    }
}

impl FromStr for Objectives {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let all: Vec<Measure> =
            text.split(',').map(|name| name.trim().parse()).collect::<Result<_, _>>()?;
        if let Some(twice) = all.iter().enumerate().find(|(i, measure)| all[..*i].contains(measure))
        {
            return Err(format!("{} is given twice; give each objective once", twice.1));
        }
        match all.len() {
            ..=MAX_OBJECTIVES => Ok(Objectives(all)),
            count => Err(format!("there are {count} objectives; give at most {MAX_OBJECTIVES}")),
        }
    }
}

/// Objectives and constraints of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Goals {
    /// Measures to be optimized.
    pub objectives: Objectives,
    /// Limits of a feasible design, on every task.
    pub constraints: Vec<Constraint>,
    /// Rule that combines the values of several tasks.
    pub aggregate: Aggregate,
}

/// Objective values and constraint violations of a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Score {
    /// Value of each objective, in its own unit and sense.
    pub values: Vec<f64>,
    /// Violation of each constraint on the worst task, as a share of its limit; 0 or below if feasible.
    pub violations: Vec<f64>,
}

impl Goals {
    /// Returns whether the success rate and whether the robust range, each under sampled errors, is an objective or
    /// is constrained.
    pub fn needs_draws(&self) -> [bool; 2] {
        [Measure::SuccessRate, Measure::RobustRange].map(|measure| {
            let constrained = self.constraints.iter().any(|bound| bound.measure == measure);
            constrained || self.objectives.measures().contains(&measure)
        })
    }

    /// Returns objectives and violations of a design; `None` if a measure has no value on one of the tasks.
    pub fn score(&self, tasks: &[&Evaluation]) -> Option<Score> {
        let value = |&measure: &Measure| self.value(measure, tasks);
        let violation =
            |constraint: &Constraint| Some(constraint.violation(constraint.worst(tasks)?));
        Some(Score {
            values: self.objectives.measures().iter().map(value).collect::<Option<_>>()?,
            violations: self.constraints.iter().map(violation).collect::<Option<_>>()?,
        })
    }

    /// Returns the value of a measure, aggregated over the tasks; `None` if it has no value on one of them.
    pub fn value(&self, measure: Measure, tasks: &[&Evaluation]) -> Option<f64> {
        let values: Option<Vec<f64>> = tasks.iter().map(|task| measure.value(task)).collect();
        Some(self.aggregate.of(measure.sense(), &values?))
    }

    /// Returns the values with the sign for which larger is better.
    pub fn gains(&self, values: &[f64]) -> Vec<f64> {
        let measures = self.objectives.measures();
        measures.iter().zip(values).map(|(measure, value)| measure.sense() * value).collect()
    }

    /// Compares the values of two designs by the first objective, then by the next ones; greater is better.
    pub fn order(&self, a: &[f64], b: &[f64]) -> Ordering {
        let (a, b) = (self.gains(a), self.gains(b));
        let differing = a.iter().zip(&b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne());
        differing.unwrap_or(Ordering::Equal)
    }

    /// Returns the values for an optimizer: those of [`score`](Goals::score) with the sign for which larger is
    /// better, interpolated within the grid step beyond each end of a window. `None` if there is no score.
    ///
    /// Windows are measured on a grid of 0.1 mm, so many designs have equal ranges, and all whose nominal start fails
    /// have a range of 0. The recorded values of a study stay on the grid.
    pub fn interpolated(&self, tasks: &[&Evaluation]) -> Option<Vec<f64>> {
        let of = |&measure: &Measure| {
            let value =
                |task: &&Evaluation| Some(measure.value(task)? + grid_correction(measure, task));
            let values: Option<Vec<f64>> = tasks.iter().map(value).collect();
            Some(measure.sense() * self.aggregate.of(measure.sense(), &values?))
        };
        self.objectives.measures().iter().map(of).collect()
    }
}

impl Score {
    /// Returns whether all constraints are satisfied.
    pub fn feasible(&self) -> bool {
        self.violations.iter().all(|&violation| violation <= 0.0)
    }
}

/// Returns the correction of a range within the grid step, mm. For a range it is the mean of the end shares times the
/// step; for a centred range, the share of the smaller side; for a failing nominal start, its negative margin. It is 0
/// for other measures. It is at most one step, so it does not reverse the order of different ranges.
fn grid_correction(measure: Measure, evaluation: &Evaluation) -> f64 {
    if !matches!(measure, Measure::Range | Measure::CentredRange) {
        return 0.0;
    }
    let (window, [below, above]) = (&evaluation.window, evaluation.end_shares);
    if window.nominal != Outcome::Inserted {
        return OFFSET_STEP_MM * below.min(0.0);
    }
    let share = match (measure, -window.negative_steps - window.positive_steps) {
        (Measure::CentredRange, smaller_below) if smaller_below < 0 => below,
        (Measure::CentredRange, smaller_above) if smaller_above > 0 => above,
        (Measure::CentredRange, _) => below.min(above),
        _ => (below + above) / 2.0,
    };
    OFFSET_STEP_MM * share
}

#[cfg(test)]
mod tests {
    use super::measure::tests::evaluation;
    use super::*;
    use crate::evaluation::tolerance::{self, Search};
    use crate::outcome::FailureClass;
    use crate::tests::fake::FakeRig;
    use crate::tests::fixtures::finger;

    fn goals(objectives: &str, constraints: &[&str], aggregate: Aggregate) -> Goals {
        Goals {
            objectives: objectives.parse().unwrap(),
            constraints: constraints.iter().map(|text| text.parse().unwrap()).collect(),
            aggregate,
        }
    }

    #[test]
    fn the_score_is_aggregated_over_tasks_and_the_worst_violation_counts() {
        let missed = Outcome::Failed(FailureClass::PlugMissed);
        // 4.7 mm with 5 N, and 2.0 mm wide with 8 N.
        let wide = evaluation(Outcome::Inserted, missed);
        let mut narrow = wide.clone();
        (narrow.window.negative_steps, narrow.peak_force_n) = (-6, 8.0);
        let tasks = [&wide, &narrow];
        let constraints = ["peak-force<=4", "range>=1"];
        let score = |objectives, aggregate| {
            goals(objectives, &constraints, aggregate).score(&tasks).unwrap()
        };
        let min = score("range,peak-force", Aggregate::Min);
        assert_eq!((min.values, min.violations), (vec![2.0, 8.0], vec![1.0, -1.0]));
        let mean = score("peak-force", Aggregate::Mean);
        assert!(mean.values == [6.5] && !mean.feasible());
        let weighted = score("range", Aggregate::Weighted(vec![2.0, 1.0]));
        assert!((weighted.values[0] - (2.0 * 4.7 + 2.0) / 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_measure_without_a_value_leaves_no_score() {
        let jammed = Outcome::Failed(FailureClass::Jammed);
        let nothing = evaluation(jammed, jammed);
        let good = evaluation(Outcome::Inserted, jammed);
        let range = goals("range", &[], Aggregate::Min);
        assert_eq!(range.score(&[&nothing]).unwrap().values, [0.0]);
        let forced = goals("range", &["peak-force<=9"], Aggregate::Min);
        assert!(forced.score(&[&good]).unwrap().feasible());
        assert_eq!(forced.score(&[&nothing]), None, "no trial inserted: there is no force");
        assert_eq!(forced.score(&[&good, &nothing]), None);
        assert_eq!(goals("success-rate", &[], Aggregate::Min).score(&[&good]), None);
    }

    #[test]
    fn the_order_is_by_the_first_objective_in_its_sense() {
        let goals = goals("peak-force,range", &[], Aggregate::Min);
        assert!(goals.order(&[3.0, 1.0], &[4.0, 9.0]).is_gt());
        assert!(goals.order(&[3.0, 1.0], &[3.0, 2.0]).is_lt());
        assert!(goals.order(&[3.0, 1.0], &[3.0, 1.0]).is_eq());
        assert_eq!(goals.needs_draws(), [false; 2]);
    }

    #[test]
    fn lists_read_back_and_have_keys_with_units() {
        let two: Objectives = "range, peak-force".parse().unwrap();
        assert_eq!((two.first(), two.single()), (Measure::Range, None));
        assert_eq!(two.to_string().parse(), Ok(two.clone()));
        assert_eq!(two.keys(), ["objective_1_mm", "objective_2_n"]);
        assert_eq!(two.show(&[4.0, 5.25]), "range 4.0 mm, peak-force 5.2 N");
        assert_eq!(Objectives::of(Measure::SuccessRate).keys(), ["objective_share"]);
        assert!("range,".parse::<Objectives>().unwrap_err().contains("``"));
    }

    fn interpolated(measure: Measure, evaluation: &Evaluation) -> f64 {
        let goals = goals(measure.name(), &[], Aggregate::Min);
        goals.interpolated(&[evaluation]).unwrap()[0]
    }

    fn measured(compliance: f64, assembly: f64) -> Evaluation {
        tolerance::evaluate(&FakeRig::default(), &finger(compliance, assembly), Search::Strides)
    }

    /// -3.333 and 1.400 mm in the closed form: 0.033 and nothing beyond the grid.
    #[test]
    fn the_correction_is_half_of_the_part_beyond_the_grid() {
        let evaluation = measured(3.0, 20.0);
        let beyond = interpolated(Measure::Range, &evaluation) - 4.7;
        assert!((beyond - 0.033_333 / 2.0).abs() < 1e-5, "{beyond}");
        let centred = interpolated(Measure::CentredRange, &evaluation) - 2.8;
        assert!(centred.abs() < 1e-5, "{centred}");
        assert_eq!(interpolated(Measure::PeakForce, &evaluation), -evaluation.peak_force_n);
    }

    #[test]
    fn the_correction_separates_equal_ranges_and_keeps_the_order_of_others() {
        let fingers = (0..200).map(|i| measured(3.0, 20.0 + 0.05 * f64::from(i)));
        let found: Vec<(f64, f64)> = fingers
            .map(|evaluation| {
                (evaluation.window.range_mm(), interpolated(Measure::Range, &evaluation))
            })
            .collect();
        assert!(found.windows(2).filter(|pair| pair[0].0 == pair[1].0).count() > 150);
        for pair in found.windows(2) {
            assert!(pair[0].1 < pair[1].1 + 1e-9, "{pair:?}");
        }
    }

    #[test]
    fn the_nearer_to_inserting_the_better_where_the_nominal_start_fails() {
        let failed = |share: f64| {
            let mut evaluation = measured(3.0, 20.0);
            evaluation.window.nominal = Outcome::Failed(FailureClass::Jammed);
            evaluation.end_shares = [share; 2];
            interpolated(Measure::Range, &evaluation)
        };
        assert!(failed(-1.0) < failed(-0.2) && failed(-0.2) < 0.0 && failed(-1.0) >= -0.1);
    }
}
