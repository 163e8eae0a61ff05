//! Named parameters and their levels.

use serde::Deserialize;

/// Largest number of steps of a parameter, and the number for a parameter without a step.
const MAX_STEPS: f64 = 1e9;
/// Tolerance of the check that a value or span is a whole number of steps, in steps.
const STEP_TOLERANCE: f64 = 1e-6;
/// Significant digits to which values are rounded.
const DIGITS: f64 = 15.0;

/// Parameter with the values `low + k step`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Parameter {
    pub name: String,
    low: f64,
    high: f64,
    /// Difference of neighbouring values; by default 1e-9 of the span.
    step: Option<f64>,
}

impl Parameter {
    /// Checks name, bounds and step.
    ///
    /// # Errors
    /// The first problem found.
    pub fn check(&self) -> Result<(), &'static str> {
        let (span, steps) = (self.high - self.low, self.steps());
        // Neighbours must differ after rounding to binary numbers.
        let largest = self.magnitude();
        let too_fine = || steps > 0.0 && span / steps < 4.0 * (largest.next_up() - largest);
        match self.step {
            _ if self.name.is_empty() => Err("a name must have at least one character"),
            _ if self.low > self.high => Err("low must not be above high"),
            _ if !span.is_finite() => Err("high - low must be a finite number"),
            Some(step) if step <= 0.0 => Err("step must be above 0"),
            Some(step) if step > span && span > 0.0 => {
                Err("step must not be larger than high - low")
            }
            Some(_) if steps > MAX_STEPS || (steps - steps.round()).abs() > STEP_TOLERANCE => {
                Err("high - low must be a whole number of steps, at most 1e9")
            }
            _ if too_fine() => {
                Err("the step is too small for low and high: neighbours would be equal")
            }
            _ => Ok(()),
        }
    }

    /// Returns the number of values.
    pub fn levels(&self) -> u32 {
        self.steps().round() as u32 + 1
    }

    fn steps(&self) -> f64 {
        let span = self.high - self.low;
        match self.step {
            _ if span == 0.0 => 0.0,
            None => MAX_STEPS,
            Some(step) => span / step,
        }
    }

    fn magnitude(&self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    fn step_width(&self) -> f64 {
        self.step.unwrap_or((self.high - self.low) / MAX_STEPS)
    }

    /// Returns the value of a level, rounded in decimals (0.1 + 2 * 0.1 is 0.3) unless rounding would
    /// lose digits of the step.
    pub fn value(&self, level: u32) -> f64 {
        if level == 0 {
            return self.low;
        }
        if level + 1 >= self.levels() {
            return self.high;
        }
        let value = self.low + f64::from(level) * self.step_width();
        let decimals = (DIGITS - 1.0 - libm::log10(self.magnitude()).floor()).max(0.0) as usize;
        let rounded = format!("{value:.decimals$}").parse().unwrap_or(value);
        let same = (rounded - value).abs() <= STEP_TOLERANCE * self.step_width();
        (if same { rounded } else { value }).clamp(self.low, self.high)
    }

    /// Returns the level of a value, counted from 0: the nearest one if the parameter has no step.
    ///
    /// # Errors
    /// If the value is not between the bounds or not on the lattice.
    pub fn level(&self, value: f64) -> Result<u32, String> {
        let Parameter { name, low, high, step } = self;
        // The width is 0 if low equals high.
        let width = self.step_width().max(f64::MIN_POSITIVE);
        let level = (((value - low) / width).round() as u32).min(self.levels() - 1);
        let near = (self.value(level) - value).abs() <= STEP_TOLERANCE * width;
        match step {
            _ if (step.is_none() || near) && (*low..=*high).contains(&value) => Ok(level),
            Some(step) => {
                Err(format!("`{name}` is {value}; accepted: {low} to {high} in steps of {step}"))
            }
            None => Err(format!("`{name}` is {value}; accepted: {low} to {high}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(low: f64, high: f64, step: Option<f64>) -> Parameter {
        let parameter = Parameter { name: "x".to_owned(), low, high, step };
        parameter.check().unwrap();
        parameter
    }

    #[test]
    fn values_read_as_they_would_be_written() {
        let axis = parameter(0.1, 0.9, Some(0.1));
        assert_eq!(axis.levels(), 9);
        let values: Vec<f64> = (0..9).map(|k| axis.value(k)).collect();
        assert_eq!(values, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]);
        assert_eq!(parameter(-5.0, 5.0, None).value(500_000_001), 1e-8);
    }

    #[test]
    fn without_a_step_the_grid_is_fine_and_both_ends_are_on_it() {
        let axis = parameter(-2.0, 3.0, None);
        assert_eq!(axis.levels(), 1_000_000_001);
        assert_eq!((axis.value(0), axis.value(1_000_000_000)), (-2.0, 3.0));
        assert_eq!((axis.value(1), axis.value(500_000_000)), (-1.999999995, 0.5));
        assert_eq!(parameter(4.0, 4.0, None).levels(), 1);
        assert_eq!(parameter(4.0, 4.0, None).level(4.0), Ok(0));
    }

    #[test]
    fn values_are_on_the_lattice_and_differ_however_large_the_bounds_are() {
        for (low, high, step) in [
            (1e15, 1e15 + 100.0, Some(1.0)),
            (-1e8 - 0.5, 1e8, Some(0.5)),
            (0.0, 1e-280, None),
            (1e300, 3e300, Some(4e291)),
            (-7.0, 1e6, None),
        ] {
            let axis = parameter(low, high, step);
            let levels = axis.levels();
            let some = (0..levels.min(50)).chain(levels.saturating_sub(50)..levels);
            let values: Vec<f64> = some.clone().map(|k| axis.value(k)).collect();
            assert!(values.windows(2).all(|pair| pair[0] < pair[1]) || levels < 100, "{low}");
            for (k, value) in some.zip(values) {
                let documented = low + f64::from(k) * axis.step_width();
                let ulp = documented.abs().next_up() - documented.abs();
                let tolerance = (3.0 * ulp).max(1.1e-6 * axis.step_width());
                assert!((value - documented).abs() <= tolerance, "{value}");
                assert_eq!(axis.level(value), Ok(k), "{low} {value}");
            }
        }
        let whole = parameter(0.0, 9.0, Some(3.0));
        let levels = [6.0, 5.0, -3.0, 12.0].map(|value| whole.level(value).ok());
        assert_eq!(levels, [Some(2), None, None, None]);
    }

    #[test]
    fn the_error_of_an_invalid_parameter_states_the_rule() {
        for (low, high, step, word) in [
            (1.0, 0.0, None, "above high"),
            (-1e308, 1e308, None, "finite"),
            (0.0, 1.0, Some(0.3), "whole number"),
            (0.0, 1.0, Some(1e-12), "at most 1e9"),
            (0.0, 1.0, Some(0.0), "above 0"),
            (0.0, 1.0, Some(1e9), "larger than"),
            (1e15, 1e15 + 1.0, Some(0.25), "too small for"),
            (1e15, 1e15 + 1.0, None, "too small for"),
            (0.3, 0.3 + 1e-12, None, "too small for"),
        ] {
            let wrong = Parameter { name: "x".to_owned(), low, high, step };
            let error = wrong.check().unwrap_err();
            assert!(error.contains(word), "{error}");
        }
    }
}
