//! Standardisation of the training values.

use super::warp::{Warp, warp};
use crate::statistics::Moments;

/// Largest number of values from which the exponent of the power transformation is estimated.
const MAX_WARP_SAMPLE: usize = 250;

/// Values in the model's units: mean 0, variance 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Standardised {
    /// One value per observation.
    pub values: Vec<f64>,
    /// The noise floor as a variance in the same units, in [1e-8, 1].
    pub noise_floor: f64,
    /// The value 0 in the units of the model; NaN after a power transformation.
    pub zero: f64,
    /// Mean of the given values, in their units.
    pub mean: f64,
    /// Standard deviation of the given values, in their units; 0 if all are equal.
    pub deviation: f64,
    /// Power transformation, if there is one.
    pub warp: Option<Warp>,
}

/// Standardises `values`; `noise_floor` is a standard deviation in objective units.
///
/// A missing, infinite or NaN value counts as the worst finite one, so that the model learns that the region is bad
/// but no extreme value dominates the fit. Equal values become zeros. Returns `None` if no value is finite.
pub(super) fn standardise(values: &[Option<f64>], noise_floor: f64) -> Option<Standardised> {
    let finite = || values.iter().flatten().copied().filter(|v| v.is_finite());
    let worst = finite().reduce(f64::min)?;
    // Dividing by the largest first keeps sums of huge values finite.
    let unit = finite().map(f64::abs).fold(f64::MIN_POSITIVE, f64::max);
    let filled: Vec<f64> =
        values.iter().map(|v| v.filter(|v| v.is_finite()).unwrap_or(worst) / unit).collect();
    let moments = Moments::of(&filled);
    let (mean, deviation) = (moments.mean, moments.deviation());
    let (values, noise_floor, zero, deviation) = match deviation < 1e-13 {
        true => (vec![0.0; filled.len()], 1e-6, -mean, 0.0),
        false => {
            let floor = noise_floor / unit / deviation;
            let values = filled.iter().map(|v| (v - mean) / deviation).collect();
            (values, (floor * floor).clamp(1e-8, 1.0), -mean / deviation, deviation * unit)
        }
    };
    Some(Standardised { values, noise_floor, zero, mean: mean * unit, deviation, warp: None })
}

impl Standardised {
    /// Returns the values under the power transformation that makes their distribution closest to normal,
    /// with the standard deviation of the noise floor multiplied by the mean slope of the transformation; returns
    /// them unchanged if no transformation is found.
    pub fn warped(self) -> Self {
        let sample: Vec<f64> =
            evenly_spaced(self.values.len(), MAX_WARP_SAMPLE).map(|i| self.values[i]).collect();
        let Some((values, warp)) = warp(&self.values, &sample) else { return self };
        let noise_floor = (self.noise_floor * warp.slope * warp.slope).clamp(1e-8, 1.0);
        Standardised { values, noise_floor, zero: f64::NAN, warp: Some(warp), ..self }
    }

    /// Converts a value to the units of the model. If all given values are equal, the result is NaN for that value
    /// and infinite for others.
    pub fn convert(&self, value: f64) -> f64 {
        let standard = (value - self.mean) / self.deviation;
        self.warp.map_or(standard, |warp| warp.apply(standard))
    }
}

/// Returns `count` evenly spaced indices below `n`, or all if `count` is larger.
pub(super) fn evenly_spaced(n: usize, count: usize) -> impl Iterator<Item = usize> {
    let count = count.min(n);
    (0..count).map(move |k| k * n / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_result_has_mean_zero_and_variance_one() {
        let s = standardise(&[Some(1.0), Some(2.0), Some(6.0)], 0.1).unwrap();
        assert!(s.values.iter().sum::<f64>().abs() < 1e-14);
        assert!((s.values.iter().map(|v| v * v).sum::<f64>() / 3.0 - 1.0).abs() < 1e-14);
        assert!((s.noise_floor - 0.01 / (14.0 / 3.0)).abs() < 1e-12);
        assert!((s.zero - (s.values[0] - (s.values[1] - s.values[0]))).abs() < 1e-12);
    }

    #[test]
    fn missing_and_infinite_values_count_as_the_worst() {
        let s =
            standardise(&[None, Some(2.0), Some(f64::NAN), Some(6.0), Some(f64::INFINITY)], 0.0);
        let s = s.unwrap().values;
        assert!(s[0] == s[1] && s[2] == s[1] && s[4] == s[1] && s[3] > s[1]);
    }

    #[test]
    fn extreme_data_stay_finite() {
        for values in [
            vec![Some(1e308), Some(-1e308), Some(1e307)],
            vec![Some(5.0); 4],
            vec![Some(0.0)],
            vec![Some(1e-310), Some(3e-310)],
        ] {
            let s = standardise(&values, 0.03).unwrap();
            assert!(s.values.iter().all(|v| v.is_finite()) && s.noise_floor.is_finite());
        }
        assert_eq!(standardise(&[None, Some(f64::NAN)], 0.1), None);
        assert_eq!(standardise(&[], 0.1), None);
    }

    #[test]
    fn indices_are_evenly_spaced_and_distinct() {
        assert_eq!(evenly_spaced(10, 3).collect::<Vec<_>>(), [0, 3, 6]);
        assert_eq!(evenly_spaced(3, 10).collect::<Vec<_>>(), [0, 1, 2]);
    }
}
