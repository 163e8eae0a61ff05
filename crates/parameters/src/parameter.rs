//! Uncertain parameter with its distribution and bounds.

use crate::numbers::Kind;
use crate::path::Path;
use ask_tell::statistics::{normal_cdf, normal_quantile};
use ask_tell::stream::stream;
use input::{Check, InputError, shown};
use rand::RngExt;
use serde::{Deserialize, Serialize};

/// Scale on which values are evenly spaced.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// Equal differences.
    #[default]
    Linear,
    /// Equal factors.
    Log,
}

/// Operation by which the value of a parameter changes the number at its path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transform {
    /// Multiplies the number.
    Factor,
    /// Adds to the number.
    Shift,
    /// Replaces the number.
    Value,
}

/// Uncertain parameter. Its distribution is uniform between the bounds or, if `value` and `sd` are given, normal and
/// truncated at the bounds. Entry of a file of priors, of levers (adjustable parameters) or of a robot cell (identified
/// values).
///
/// Value, standard deviation and bounds are in the unit of the path; those of a [`Transform::Factor`] have no unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// Descriptive name: `friction plug-socket`.
    pub name: String,
    /// Path of the number that it sets.
    #[serde(rename = "sets")]
    pub path: Path,
    /// Operation on the number.
    #[serde(rename = "as")]
    pub transform: Transform,
    /// Scale of the distribution: uniform or normal in the value or in its logarithm.
    pub scale: Scale,
    /// Median before truncation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Standard deviation before truncation; on a log scale `sd / value` is that of the logarithm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sd: Option<f64>,
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
    /// Whether all tasks share one value.
    pub shared: bool,
    /// Source of the value or the bounds.
    pub source: String,
}

impl Parameter {
    /// Returns a parameter with a uniform distribution between two values.
    pub fn uniform(path: Path, [low, high]: [f64; 2]) -> Self {
        Parameter {
            name: path.to_string(),
            path,
            transform: Transform::Value,
            scale: Scale::Linear,
            value: None,
            sd: None,
            low,
            high,
            shared: true,
            source: String::new(),
        }
    }

    /// Returns the quantile of the distribution at probability `share`, 0 to 1.
    pub fn at(&self, share: f64) -> f64 {
        let Parameter { low, high, .. } = *self;
        match (self.scale, self.value.zip(self.sd)) {
            (Scale::Linear, None) => low + share * (high - low),
            (Scale::Log, None) => low * libm::exp(share * libm::log(high / low)),
            (_, Some((value, 0.0))) => value,
            (Scale::Linear, Some((value, sd))) => {
                let [from, to] = [low, high].map(|bound| (bound - value) / sd);
                (value + sd * truncated_normal_quantile(share, from, to)).clamp(low, high)
            }
            (Scale::Log, Some((value, sd))) => {
                let sd = sd / value;
                let [from, to] = [low, high].map(|bound| libm::log(bound / value) / sd);
                (value * libm::exp(sd * truncated_normal_quantile(share, from, to)))
                    .clamp(low, high)
            }
        }
    }

    /// Returns the nominal value: `value` if given, else the median of the uniform distribution.
    pub fn middle(&self) -> f64 {
        self.value.unwrap_or_else(|| self.at(0.5))
    }

    /// Returns a number as changed by a value of the parameter.
    pub fn applied(&self, number: f64, value: f64) -> f64 {
        match self.transform {
            Transform::Factor => number * value,
            Transform::Shift => number + value,
            Transform::Value => value,
        }
    }

    /// Returns the value of the parameter that leaves a number unchanged.
    pub fn neutral(&self, number: f64) -> f64 {
        match self.transform {
            Transform::Factor => 1.0,
            Transform::Shift => 0.0,
            Transform::Value => number,
        }
    }

    /// Returns values of the parameter, given as text, with the sign of a factor or with their unit.
    pub fn with_unit(&self, values: &str) -> String {
        match self.transform {
            Transform::Factor => format!("× {values}"),
            Transform::Shift | Transform::Value => format!("{values}{}", self.path.unit()),
        }
    }

    /// Checks a parameter read from a file.
    ///
    /// # Errors
    /// If a bound, the value or the transform cannot be used with this path.
    pub fn check(&self, check: Check<'_>) -> Result<(), InputError> {
        let Parameter { name, low, high, scale, .. } = self;
        check.finite(name, *low)?;
        check.finite(name, *high)?;
        if low >= high {
            return check.fail(name, "low must be below high");
        }
        if (*scale == Scale::Log || self.transform == Transform::Factor) && *low <= 0.0 {
            return check.fail(name, "low must be above 0 for a factor or on a log scale");
        }
        if let Some(problem) = self.mismatch() {
            return check.fail(name, problem);
        }
        let (value, sd) = match (self.value, self.sd) {
            (None, None) => return Ok(()),
            (Some(value), Some(sd)) => (value, sd),
            _ => return check.fail(name, "value and sd go together: give both, or neither"),
        };
        check.finite(name, value)?;
        check.not_negative(name, sd)?;
        match (*low..=*high).contains(&value) {
            true => Ok(()),
            false => check.fail(name, format!("value must lie in {low} .. {high}")),
        }
    }

    /// Returns an error message if bounds or transform do not suit the path.
    fn mismatch(&self) -> Option<String> {
        use Transform::{Factor, Shift, Value};
        let path = &self.path;
        let [least, most] = path.bounds();
        let within = self.low >= least && self.high <= most;
        let problem = match (path.kind(), self.transform) {
            (Kind::Infill | Kind::Error, _) => &format!(
                "`{path}` cannot be set by a cell; set it in a space or an uncertainty file"
            ),
            (Kind::Added, Factor) => "must be as = \"shift\": its nominal value is 0",
            (Kind::Springs, Shift | Value) => "must be as = \"factor\": it sets two stiffnesses",
            (Kind::Finger | Kind::Robot, Shift) if least > 0.0 => {
                "must be as = \"factor\" or \"value\": it stays above 0"
            }
            (Kind::Added, _) | (_, Value) if !within => {
                &format!("low and high must lie in {} .. {}", shown(least), shown(most))
            }
            _ => return None,
        };
        Some(problem.to_owned())
    }
}

/// Returns the quantile of the standard normal distribution truncated to `from .. to`.
fn truncated_normal_quantile(share: f64, from: f64, to: f64) -> f64 {
    let [below, above] = [from, to].map(normal_cdf);
    normal_quantile(below + share * (above - below))
}

/// Prefix of the name of a parameter's random stream; the path follows. Each parameter has its own stream, so that
/// adding or removing one does not change the draws of the others.
const PURPOSE: &str = "cell ";

/// Returns `count` draws, each with one value per parameter, in their order. Draw `i` of a parameter depends only on
/// its distribution and path, the seed and `i`.
pub fn draws(parameters: &[Parameter], seed: u64, count: u32) -> Vec<Vec<f64>> {
    let draw = |i: u32| {
        let share =
            |path: &Path| stream(seed, u64::from(i), &format!("{PURPOSE}{path}")).random::<f64>();
        parameters.iter().map(|parameter| parameter.at(share(&parameter.path))).collect()
    };
    (0..count).map(draw).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::FRICTION;
    use proptest::prelude::*;

    fn friction(scale: Scale, value: Option<f64>, sd: Option<f64>) -> Parameter {
        let path = Path::new(FRICTION).unwrap();
        let uniform = Parameter::uniform(path, [0.5, 2.0]);
        Parameter { scale, value, sd, transform: Transform::Factor, ..uniform }
    }

    /// The quartiles of a normal distribution lie 0.674490 standard deviations from its median.
    #[test]
    fn value_and_deviation_make_it_normal_within_its_bounds() {
        let with = |scale, sd| friction(scale, Some(1.2), Some(sd));
        let (linear, log) = (with(Scale::Linear, 0.03), with(Scale::Log, 0.03));
        assert!((linear.at(0.25) - (1.2 - 0.03 * 0.674_490)).abs() < 1e-6);
        assert!((log.at(0.75) - 1.2 * libm::exp(0.03 / 1.2 * 0.674_490)).abs() < 1e-6);
        for row in
            [linear, log, with(Scale::Linear, 3.0), with(Scale::Log, 3.0), with(Scale::Log, 0.0)]
        {
            assert_eq!(row.middle(), 1.2);
        }
        let wide = with(Scale::Linear, 1e6);
        assert!((wide.at(0.25) - 0.875).abs() < 1e-6, "all but even: {}", wide.at(0.25));
    }

    #[test]
    fn a_factor_a_shift_and_a_value_leave_a_number_as_it_is_at_their_neutral() {
        for transform in [Transform::Factor, Transform::Shift, Transform::Value] {
            let one = Parameter { transform, ..friction(Scale::Linear, None, None) };
            assert_eq!(one.applied(0.3, one.neutral(0.3)), 0.3);
            assert_ne!(one.applied(0.3, 0.7), 0.3);
        }
    }

    #[test]
    fn a_draw_of_one_parameter_does_not_depend_on_the_others() {
        let all = [FRICTION, "task.grip.force_n", "finger.rcc_mm"]
            .map(|path| Parameter::uniform(Path::new(path).unwrap(), [1.0, 2.0]));
        let drawn = draws(&all, 7, 20);
        for (i, one) in all.iter().enumerate() {
            let alone = draws(std::slice::from_ref(one), 7, 9);
            assert!(alone.iter().zip(&drawn).all(|(alone, all)| alone[0] == all[i]));
        }
        assert!(drawn.iter().all(|draw| draw[0] != draw[1]));
        assert_ne!(draws(&all, 8, 20), drawn);
    }

    proptest! {
        /// For each accepted parameter, draws lie within the bounds and quantiles do not decrease with the probability.
        #[test]
        fn draws_lie_within_the_bounds(
            low in 1e-3..1e3f64,
            width in 1e-6..1e3f64,
            share_of_value in 0.0..=1.0f64,
            sd in 0.0..1e4f64,
            normal in any::<bool>(),
            log in any::<bool>(),
            seed in any::<u64>(),
        ) {
            let high = low + width;
            let value = normal.then_some((low + share_of_value * width).min(high));
            let scale = if log { Scale::Log } else { Scale::Linear };
            let row = Parameter { low, high, source: "test".to_owned(), ..friction(scale, value, normal.then_some(sd)) };
            let checked = row.check(Check { file: "p" });
            prop_assert!(checked.is_ok(), "{checked:?}");
            let last_place = 1e-12 * high;
            let within = |value: f64| low - last_place <= value && value <= high + last_place;
            for draw in draws(std::slice::from_ref(&row), seed, 20) {
                prop_assert!(within(draw[0]), "{} of {row:?}", draw[0]);
            }
            let rising: Vec<f64> = (0..=20).map(|i| row.at(f64::from(i) / 20.0)).collect();
            prop_assert!(rising.is_sorted_by(|a, b| *a <= b + last_place), "{rising:?} of {row:?}");
        }
    }
}
