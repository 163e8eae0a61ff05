//! Aggregation over several tasks.

use ask_tell::statistics::weighted_mean;
use input::shown;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Aggregation of the values of several tasks. The values are not scaled: in a mean, tasks with wide windows have more
/// influence than tasks with narrow ones.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Aggregate {
    /// Worst value: the smallest of a measure that is maximized, the largest of one that is minimized.
    #[default]
    Min,
    /// Arithmetic mean over the tasks.
    Mean,
    /// Weighted mean with one weight above 0 per task.
    Weighted(Vec<f64>),
}

/// Name of an [`Aggregate`], without its weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum AggregateKind {
    /// The worst value
    Min,
    /// The mean, not scaled: tasks with wide windows have more influence
    Mean,
    /// The mean with --weights
    Weighted,
}

impl Aggregate {
    /// Returns the weighted mean over a number of tasks.
    ///
    /// # Errors
    /// If the numbers of weights and tasks differ, or a weight is out of range.
    pub fn weighted(weights: Vec<f64>, tasks: usize) -> Result<Self, String> {
        let count = weights.len();
        if count != tasks {
            return Err(format!("there are {count} weights for {tasks} tasks; give one for each"));
        }
        if let Some(bad) = weights.iter().find(|weight| !(1e-6..=1e6).contains(*weight)) {
            let bad = shown(*bad);
            return Err(format!("weight {bad} is out of range; it must lie in 1e-6 .. 1e6"));
        }
        Ok(Aggregate::Weighted(weights))
    }

    /// Returns the aggregate of the values of at least one task; `sense` is 1 to maximize, -1 to minimize.
    pub fn of(&self, sense: f64, values: &[f64]) -> f64 {
        match self {
            // A weighted mean of a single value could differ from it in the last digit.
            _ if values.len() == 1 => values[0],
            Aggregate::Min => {
                sense * values.iter().map(|value| sense * value).fold(f64::INFINITY, f64::min)
            }
            Aggregate::Mean => weighted_mean(values.iter().map(|value| (*value, 1.0))),
            Aggregate::Weighted(weights) => {
                weighted_mean(values.iter().copied().zip(weights.iter().copied()))
            }
        }
    }
}

impl fmt::Display for Aggregate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Aggregate::Min => f.write_str("min"),
            Aggregate::Mean => f.write_str("mean"),
            Aggregate::Weighted(weights) => {
                let weights: Vec<String> = weights.iter().map(f64::to_string).collect();
                write!(f, "weighted {}", weights.join(","))
            }
        }
    }
}

impl FromStr for Aggregate {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(' ') {
            None if text == "min" => Ok(Aggregate::Min),
            None if text == "mean" => Ok(Aggregate::Mean),
            Some(("weighted", weights)) => {
                let weights: Result<Vec<f64>, _> = weights.split(',').map(str::parse).collect();
                let weights = weights.map_err(|error| format!("weights: {error}"))?;
                let tasks = weights.len();
                Aggregate::weighted(weights, tasks)
            }
            _ => Err(format!("unknown aggregate `{text}`; available: min, mean, weighted W,W..")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::refused;

    #[test]
    fn one_value_for_several() {
        let two = Aggregate::weighted(vec![2.0, 1.0], 2).unwrap();
        assert_eq!(two.of(1.0, &[3.0, 6.0]), 4.0);
        assert_eq!(Aggregate::Mean.of(1.0, &[3.0, 6.0]), 4.5);
        assert_eq!(Aggregate::Min.of(1.0, &[3.0, 6.0]), 3.0);
        assert_eq!(Aggregate::Min.of(-1.0, &[3.0, 6.0]), 6.0, "the worse force is the larger");
        for aggregate in [two, Aggregate::Mean, Aggregate::Min] {
            assert_eq!(aggregate.to_string().parse(), Ok(aggregate.clone()));
            assert_eq!(aggregate.of(1.0, &[0.1]), 0.1);
        }
        refused(Aggregate::weighted(vec![1e308, 1.0], 2), &["weight 1e308 is out"]);
        assert!("weighted".parse::<Aggregate>().is_err());
    }
}
