//! A parameter, and the levels an optimizer sees of it.

use super::decimal::Decimal;
use serde::Deserialize;

/// Steps of a parameter that names none: each is 1e-9 of its span.
const FINE_STEPS: u32 = 1_000_000_000;
/// The same as a power of ten.
const FINE_DIGITS: i32 = 9;
/// Most steps of a parameter.
const MOST_STEPS: f64 = 1e9;
/// How far from whole the number of steps may be.
const WHOLE: f64 = 1e-6;

/// A parameter as the first line names it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ParameterLine {
    pub name: String,
    pub low: f64,
    pub high: f64,
    /// Values are `low + k step`; without it any value to 1e-9 of the span.
    pub step: Option<f64>,
}

/// A checked parameter.
#[derive(Debug)]
pub(super) struct Parameter {
    pub line: ParameterLine,
    steps: u32,
    /// `low` and the step, where their sums have few enough digits.
    exact: Option<(Decimal, Decimal)>,
}

impl Parameter {
    pub fn new(line: ParameterLine) -> Result<Parameter, String> {
        let fail = |problem| Err(format!("parameter `{}`: {problem}", line.name));
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
        let (low, high) = (line.low, line.high);
        // Rounding to binary numbers must not make one of two neighbours.
        let largest = low.abs().max(high.abs());
        if steps > 0 && span / f64::from(steps) < 4.0 * (largest.next_up() - largest) {
            return fail("its steps are too small beside low and high: neighbours would be equal");
        }
        let exact = || {
            let first = Decimal::of(low)?;
            let step = match line.step {
                Some(step) => Decimal::of(step)?,
                None => Decimal::of(high)?.plus(-1, first)?.over_ten_to(FINE_DIGITS),
            };
            // If the last sum has few enough digits, all have.
            first.plus(i128::from(steps), step)?;
            Some((first, step))
        };
        Ok(Parameter { exact: exact(), line, steps })
    }

    pub fn levels(&self) -> u32 {
        self.steps + 1
    }

    /// The value of a level: the last is `high` itself.
    pub fn value(&self, level: u32) -> f64 {
        if level == 0 {
            return self.line.low;
        }
        if level >= self.steps {
            return self.line.high;
        }
        let exact = || {
            let (low, step) = self.exact?;
            Some(low.plus(i128::from(level), step)?.nearest())
        };
        let value = exact().unwrap_or_else(|| self.line.low + f64::from(level) * self.width());
        value.clamp(self.line.low, self.line.high)
    }

    fn width(&self) -> f64 {
        self.line.step.unwrap_or((self.line.high - self.line.low) / f64::from(self.steps.max(1)))
    }

    /// The level with this value: the nearest where no step is named.
    pub fn level(&self, value: f64) -> Option<u32> {
        if !(self.line.low..=self.line.high).contains(&value) {
            return None;
        }
        // The width may be subnormal, and is 0 where low is high.
        let width = self.width();
        let level = if width > 0.0 { ((value - self.line.low) / width).round() } else { 0.0 };
        let level = (level as u32).min(self.steps);
        let off = (self.value(level) - value).abs();
        (self.line.step.is_none() || off <= WHOLE * self.width()).then_some(level)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(low: f64, high: f64, step: Option<f64>) -> ParameterLine {
        ParameterLine { name: "x".to_owned(), low, high, step }
    }

    #[test]
    fn values_read_as_they_would_be_written() {
        let axis = Parameter::new(line(0.1, 0.9, Some(0.1))).unwrap();
        assert_eq!(axis.levels(), 9);
        let values: Vec<f64> = (0..9).map(|k| axis.value(k)).collect();
        assert_eq!(values, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]);
    }

    #[test]
    fn without_a_step_the_grid_is_fine_and_both_ends_are_on_it() {
        let axis = Parameter::new(line(-2.0, 3.0, None)).unwrap();
        assert_eq!(axis.levels(), 1_000_000_001);
        assert_eq!((axis.value(0), axis.value(1_000_000_000)), (-2.0, 3.0));
        assert_eq!((axis.value(1), axis.value(500_000_000)), (-1.999999995, 0.5));
        assert_eq!(Parameter::new(line(4.0, 4.0, None)).unwrap().levels(), 1);
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
            let axis = Parameter::new(line(low, high, step)).unwrap();
            let levels = axis.levels();
            let some = (0..levels.min(50)).chain(levels.saturating_sub(50)..levels);
            let values: Vec<f64> = some.clone().map(|k| axis.value(k)).collect();
            assert!(values.windows(2).all(|pair| pair[0] < pair[1]) || levels < 100, "{low}");
            for (k, value) in some.zip(values) {
                let documented = low + f64::from(k) * axis.width();
                let ulp = documented.abs().next_up() - documented.abs();
                assert!(
                    (value - documented).abs() <= 3.0 * ulp.max(1e-9 * axis.width()),
                    "{value}"
                );
                assert_eq!(axis.level(value), Some(k), "{low} {value}");
            }
        }
        let whole = Parameter::new(line(0.0, 9.0, Some(3.0))).unwrap();
        assert_eq!([6.0, 5.0, -3.0, 12.0].map(|v| whole.level(v)), [Some(2), None, None, None]);
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
            (line(1e15, 1e15 + 1.0, Some(0.25)), "too small beside"),
            (line(1e15, 1e15 + 1.0, None), "too small beside"),
            (line(0.3, 0.3 + 1e-12, None), "too small beside"),
        ] {
            let error = Parameter::new(wrong).unwrap_err();
            assert!(error.contains(word) && error.contains("`x`"), "{error}");
        }
    }
}
