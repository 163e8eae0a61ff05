//! Statistics of samples, and the normal distribution.

use libm::{erfc, exp, log, log1p, sqrt};
use std::borrow::Borrow;
use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

/// Returns the mean; `None` without values.
pub fn mean(values: impl IntoIterator<Item = impl Borrow<f64>>) -> Option<f64> {
    let mut count = 0.0;
    let counted = values.into_iter().map(|value| *value.borrow()).inspect(|_| count += 1.0);
    let sum: f64 = counted.sum();
    (count > 0.0).then(|| sum / count)
}

/// Returns the mean of pairs of a value and its weight; NaN without pairs.
pub fn weighted_mean(pairs: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    let add = |(sum, total), (value, weight)| (sum + value * weight, total + weight);
    let (sum, total) = pairs.into_iter().fold((0.0, 0.0), add);
    sum / total
}

/// Number, mean and sum of squared deviations of values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// Number of values.
    pub count: f64,
    /// Mean; NaN without values.
    pub mean: f64,
    /// Sum of the squared deviations from the mean.
    pub squares: f64,
}

impl Moments {
    /// Returns the moments of the values. The iterator is cloned and traversed more than once.
    pub fn of(values: impl IntoIterator<Item: Borrow<f64>, IntoIter: Clone>) -> Self {
        let values = values.into_iter().map(|value| *value.borrow());
        let count = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / count;
        Moments { count, mean, squares: values.map(|value| (value - mean).powi(2)).sum() }
    }

    /// Returns the population variance (divisor n); NaN without values.
    pub fn variance(&self) -> f64 {
        self.squares / self.count
    }

    /// Returns the square root of [`Moments::variance`].
    pub fn deviation(&self) -> f64 {
        self.variance().sqrt()
    }

    /// Returns the unbiased sample variance (divisor n - 1); NaN for fewer than two values.
    pub fn sample_variance(&self) -> f64 {
        if self.count > 1.0 { self.squares / (self.count - 1.0) } else { f64::NAN }
    }

    /// Returns the square root of [`Moments::sample_variance`].
    pub fn sample_deviation(&self) -> f64 {
        self.sample_variance().sqrt()
    }
}

/// Returns the smallest and the largest value; infinity and minus infinity without values.
pub fn span(values: impl IntoIterator<Item = impl Borrow<f64>>) -> [f64; 2] {
    let values = values.into_iter().map(|value| *value.borrow());
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

/// Returns the median; `None` without values. For an even number of values it is the larger of
/// the two middle ones.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    quantile(&sorted(values), 0.5)
}

/// Returns the values in ascending order.
pub fn sorted(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Returns the quantile of sorted values at a probability (0 to 1), rounded to the nearest rank;
/// `None` without values.
pub fn quantile(sorted: &[f64], probability: f64) -> Option<f64> {
    let rank = probability * sorted.len().checked_sub(1)? as f64;
    sorted.get(rank.round() as usize).copied()
}

/// Returns the quantile of sorted values, interpolated linearly between the two nearest ranks.
pub fn interpolated_quantile(sorted: &[f64], probability: f64) -> Option<f64> {
    let rank = probability * sorted.len().checked_sub(1)? as f64;
    let [low, high] = [rank.floor(), rank.ceil()].map(|at| sorted.get(at as usize).copied());
    let part = rank - rank.floor();
    if part == 0.0 { low } else { Some(low? + part * (high? - low?)) }
}

/// Returns Pearson's correlation coefficient; `None` if either variable is constant.
pub fn pearson(first: &[f64], second: &[f64]) -> Option<f64> {
    let (first_mean, second_mean) = (mean(first)?, mean(second)?);
    let sum = |of: fn(f64, f64) -> f64| -> f64 {
        first.iter().zip(second).map(|(a, b)| of(a - first_mean, b - second_mean)).sum()
    };
    let scale = (sum(|a, _| a * a) * sum(|_, b| b * b)).sqrt();
    (scale > 0.0).then(|| sum(|a, b| a * b) / scale)
}

/// Returns Spearman's rank correlation; `None` for fewer than 3 pairs or a constant variable.
pub fn spearman(pairs: &[(f64, f64)]) -> Option<f64> {
    let (first, second): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
    if pairs.len() < 3 { None } else { pearson(&ranks(&first), &ranks(&second)) }
}

/// Returns the ranks, from 0; tied values share the mean of their ranks.
fn ranks(values: &[f64]) -> Vec<f64> {
    let rank = |v: &f64| {
        let below = values.iter().filter(|other| *other < v).count() as f64;
        let equal = values.iter().filter(|other| *other == v).count() as f64;
        below + (equal - 1.0) / 2.0
    };
    values.iter().map(rank).collect()
}

/// Returns the density of the standard normal distribution.
pub fn normal_pdf(z: f64) -> f64 {
    exp(-0.5 * z * z) / (SQRT_2 * sqrt(PI))
}

/// Returns the logarithm of [`normal_pdf`].
pub fn normal_log_pdf(z: f64) -> f64 {
    -0.5 * z * z - 0.5 * log(2.0 * PI)
}

/// Returns the cumulative distribution function of the standard normal distribution.
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * erfc(-z * FRAC_1_SQRT_2)
}

/// Returns the logarithm of [`normal_cdf`], accurate even where `normal_cdf` underflows.
pub fn normal_log_cdf(z: f64) -> f64 {
    if z > -30.0 {
        return log(normal_cdf(z));
    }
    // The first terms of Mills' ratio (1 - cdf) / pdf at x = -z: 1/x - 1/x^3 + 3/x^5 - ...
    let inverse = 1.0 / (z * z);
    normal_log_pdf(z) - log(-z) + log1p(-inverse * (1.0 - 3.0 * inverse))
}

/// Returns the inverse of [`normal_cdf`], by bisection between -40 and 40.
pub fn normal_quantile(probability: f64) -> f64 {
    let (mut low, mut high) = (-40.0, 40.0);
    for _ in 0..100 {
        let middle = (low + high) / 2.0;
        let below = normal_cdf(middle) < probability;
        *(if below { &mut low } else { &mut high }) = middle;
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_and_quantiles_by_hand() {
        let values = [4.0, 1.0, 7.0, 2.0];
        let moments = Moments::of(values);
        assert_eq!((moments.mean, moments.squares), (3.5, 21.0));
        assert_eq!((moments.variance(), moments.sample_variance()), (5.25, 7.0));
        assert!(Moments::of(values[..1].iter()).sample_deviation().is_nan());
        assert_eq!((mean(values), mean([0.0; 0])), (Some(3.5), None));
        assert_eq!((median(values), median([])), (Some(4.0), None));
        let sorted = sorted(values);
        let whole = [0.0, 0.25, 0.75, 1.0].map(|at| quantile(&sorted, at));
        assert_eq!(whole, [1., 2., 4., 7.].map(Some));
        let between = [0.0, 0.25, 0.5, 1.0].map(|at| interpolated_quantile(&sorted, at));
        assert_eq!(between, [1., 1.75, 3., 7.].map(Some));
    }

    #[test]
    fn rank_correlations_by_hand() {
        // Ranks 0 1 2 3 against 1 0 3 2: 1 - 6 * 4 / (4 * 15) = 0.6.
        let close = |found: Option<f64>, r: f64| (found.unwrap() - r).abs() < 1e-12;
        assert!(close(spearman(&[(1.0, 20.0), (2.0, 10.0), (3.0, 40.0), (9.0, 30.0)]), 0.6));
        // Centred ranks -1 0 1 against 0.5 0.5 -1: -1.5 / sqrt(2 * 1.5).
        assert!(close(spearman(&[(1.0, 5.0), (2.0, 5.0), (3.0, 4.0)]), -0.75f64.sqrt()));
        assert_eq!(spearman(&[(1.0, 1.0), (2.0, 1.0), (3.0, 1.0)]), None);
        assert_eq!(spearman(&[(1.0, 1.0), (2.0, 2.0)]), None);
    }

    #[test]
    fn the_log_of_the_distribution_is_smooth_where_the_formulas_meet() {
        // log Phi(-1.96), log Phi(0) and log Phi(-35), computed with 60 digits (mpmath).
        for (z, expected) in [
            (0.0, -std::f64::consts::LN_2),
            (-1.96, -3.688_963_651_729_639),
            (-35.0, -616.975_101_261_922_5),
        ] {
            let error = (normal_log_cdf(z) / expected - 1.0).abs();
            assert!(error < 1e-8, "{z}: {} not {expected}", normal_log_cdf(z));
        }
        let (above, below) = (normal_log_cdf(-29.999_999), normal_log_cdf(-30.000_001));
        assert!(above > below && above - below < 1e-4);
    }

    #[test]
    fn the_quantile_inverts_the_distribution_whose_slope_is_the_density() {
        for z in [-6.0, -1.96, 0.0, 0.5, 3.0] {
            assert!((normal_quantile(normal_cdf(z)) - z).abs() < 1e-9 * normal_pdf(z).recip());
            let slope = (normal_cdf(z + 1e-4) - normal_cdf(z - 1e-4)) / 2e-4;
            assert!((slope / normal_pdf(z) - 1.0).abs() < 1e-5, "{z}");
            assert!((exp(normal_log_pdf(z)) / normal_pdf(z) - 1.0).abs() < 1e-14);
        }
    }
}
