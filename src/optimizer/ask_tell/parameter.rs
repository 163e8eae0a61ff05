//! A parameter, and the levels an optimizer sees of it.

use super::AskTellError;
use serde::Deserialize;

/// Steps of a parameter that names none: each is 1e-9 of its span.
const FINE_STEPS: u32 = 1_000_000_000;
/// Most steps of a parameter.
const MOST_STEPS: f64 = 1e9;
/// How far from whole the number of steps may be.
const WHOLE: f64 = 1e-6;

/// A parameter as the first line names it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterLine {
    /// Its name in the points asked.
    pub name: String,
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Values are `low + k step`; without it any value to 1e-9 of the span.
    #[serde(default)]
    pub step: Option<f64>,
}

/// A checked parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    low: f64,
    high: f64,
    step: Option<f64>,
    steps: u32,
}

impl Parameter {
    /// Checks a parameter.
    pub fn new(line: &ParameterLine) -> Result<Parameter, AskTellError> {
        let fail = |problem| {
            let name = line.name.clone();
            Err(AskTellError::Parameter { name, problem })
        };
        let span = line.high - line.low;
        if line.name.is_empty() {
            return fail("a name must have at least one character");
        }
        if line.low > line.high {
            return fail("low must not be above high");
        }
        if !span.is_finite() {
            return fail("high - low must be a finite number");
        }
        let steps = match line.step {
            _ if span == 0.0 => 0,
            None => FINE_STEPS,
            Some(step) if step > 0.0 => {
                let steps = span / step;
                if steps > MOST_STEPS || (steps - steps.round()).abs() > WHOLE {
                    return fail("high - low must be a whole number of steps, at most 1e9");
                }
                steps.round() as u32
            }
            Some(_) => return fail("step must be above 0"),
        };
        if line.step.is_some() && steps == 0 && span > 0.0 {
            return fail("step must not be larger than high - low");
        }
        let (low, high, step) = (line.low, line.high, line.step);
        Ok(Parameter { name: line.name.clone(), low, high, step, steps })
    }

    /// Number of distinct values.
    pub fn levels(&self) -> u32 {
        self.steps + 1
    }

    /// The value of a level: the last is `high` itself.
    pub fn value(&self, level: u32) -> f64 {
        if level == 0 {
            return self.low;
        }
        if level >= self.steps {
            return self.high;
        }
        let share = f64::from(level) / f64::from(self.steps);
        let value = match self.step {
            Some(step) => self.low + f64::from(level) * step,
            None => self.low + (self.high - self.low) * share,
        };
        fifteen_digits(value).clamp(self.low, self.high)
    }
}

/// 0.1 + 2 · 0.1 is to read 0.3, not 0.30000000000000004.
fn fifteen_digits(value: f64) -> f64 {
    format!("{value:.14e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(low: f64, high: f64, step: Option<f64>) -> ParameterLine {
        ParameterLine { name: "x".to_owned(), low, high, step }
    }

    #[test]
    fn values_read_as_they_would_be_written() {
        let axis = Parameter::new(&line(0.1, 0.9, Some(0.1))).unwrap();
        assert_eq!(axis.levels(), 9);
        let values: Vec<f64> = (0..9).map(|k| axis.value(k)).collect();
        assert_eq!(values, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]);
    }

    #[test]
    fn without_a_step_the_grid_is_fine_and_both_ends_are_on_it() {
        let axis = Parameter::new(&line(-2.0, 3.0, None)).unwrap();
        assert_eq!(axis.levels(), 1_000_000_001);
        assert_eq!((axis.value(0), axis.value(1_000_000_000)), (-2.0, 3.0));
        assert_eq!((axis.value(1), axis.value(500_000_000)), (-1.999999995, 0.5));
        assert_eq!(Parameter::new(&line(4.0, 4.0, None)).unwrap().levels(), 1);
    }

    #[test]
    fn each_wrong_parameter_is_answered_with_what_is_right() {
        for (wrong, word) in [
            (line(1.0, 0.0, None), "above high"),
            (line(-1e308, 1e308, None), "finite"),
            (line(0.0, 1.0, Some(0.3)), "whole number"),
            (line(0.0, 1.0, Some(1e-12)), "at most 1e9"),
            (line(0.0, 1.0, Some(0.0)), "above 0"),
            (line(0.0, 1.0, Some(1e9)), "larger than"),
        ] {
            let error = Parameter::new(&wrong).unwrap_err().to_string();
            assert!(error.contains(word) && error.contains("`x`"), "{error}");
        }
    }
}
