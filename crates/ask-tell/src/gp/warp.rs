//! Yeo-Johnson power transformation (Biometrika 87, 2000) of the training values.
//!
//! Objectives with a long tail (a few very bad designs, or a narrow peak over a wide plain)
//! are poorly modelled by a Gaussian process. The exponent that makes the values most nearly
//! normal is chosen by maximum likelihood. The transformation is strictly increasing, so it
//! preserves the order of the values.

use crate::statistics::Moments;
use libm::{exp, log, log1p, pow};

/// Power transformation followed by standardisation to mean 0 and variance 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Warp {
    /// Exponent.
    lambda: f64,
    mean: f64,
    deviation: f64,
    /// Geometric mean of the slope of the transformation over the training values.
    pub slope: f64,
}

impl Warp {
    /// Transforms a standardised value.
    pub fn apply(&self, value: f64) -> f64 {
        (yeo_johnson(value, self.lambda) - self.mean) / self.deviation
    }
}

/// Fits the transformation to standardised values; returns the transformed values and the transformation.
/// The exponent is the most likely one of -1, -0.9 .. 3 (1 is the identity) for `sample`, a subset of the
/// values. Returns `None` if no exponent gives finite values that differ.
pub(super) fn warp(values: &[f64], sample: &[f64]) -> Option<(Vec<f64>, Warp)> {
    let lambdas = (-10..=30).map(|tenths| f64::from(tenths) / 10.0);
    let scored = lambdas.map(|lambda| (warped(sample, lambda).0, lambda));
    let finite = scored.filter(|(likelihood, _)| likelihood.is_finite());
    let (_, lambda) = finite.reduce(|best, next| if next.0 > best.0 { next } else { best })?;
    let (likelihood, values, warp) = warped(values, lambda);
    likelihood.is_finite().then_some((values, warp))
}

/// Returns the log likelihood of one exponent, the transformed values, and the transformation.
fn warped(values: &[f64], lambda: f64) -> (f64, Vec<f64>, Warp) {
    let n = values.len() as f64;
    // log of the transformation's slope is (lambda - 1) times this, summed over the values.
    let log_slope: f64 = values.iter().map(|y| y.signum() * log1p(y.abs())).sum();
    let transformed: Vec<f64> = values.iter().map(|&y| yeo_johnson(y, lambda)).collect();
    let moments = Moments::of(&transformed);
    let likelihood = -0.5 * n * log(moments.variance()) + (lambda - 1.0) * log_slope;
    let (mean, deviation) = (moments.mean, moments.deviation());
    let values = transformed.iter().map(|t| (t - mean) / deviation).collect();
    let slope = exp((lambda - 1.0) * log_slope / n) / deviation;
    (likelihood, values, Warp { lambda, mean, deviation, slope })
}

fn yeo_johnson(y: f64, lambda: f64) -> f64 {
    let power = |base: f64, exponent: f64| {
        if exponent.abs() < 1e-9 { log(base) } else { (pow(base, exponent) - 1.0) / exponent }
    };
    if y >= 0.0 { power(1.0 + y, lambda) } else { -power(1.0 - y, 2.0 - lambda) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_kept_and_one_is_the_identity() {
        for step in -10..=30 {
            let lambda = f64::from(step) / 10.0;
            let mut last = f64::NEG_INFINITY;
            for k in -50..=50 {
                let y = f64::from(k) / 10.0;
                let t = yeo_johnson(y, lambda);
                assert!(t > last && (lambda != 1.0 || (t - y).abs() < 1e-12), "{lambda} {y}");
                last = t;
            }
        }
    }

    #[test]
    fn a_long_tail_is_drawn_in() {
        let raw: Vec<f64> = (0..30).map(|k| libm::exp(f64::from(k) / 6.0)).collect();
        let mean = raw.iter().sum::<f64>() / 30.0;
        let deviation = (raw.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 30.0).sqrt();
        let standard: Vec<f64> = raw.iter().map(|v| (v - mean) / deviation).collect();
        let (values, warp) = warp(&standard, &standard).unwrap();
        assert!(standard.iter().zip(&values).all(|(&y, t)| (warp.apply(y) - t).abs() < 1e-12));
        let skew = |v: &[f64]| v.iter().map(|t| t.powi(3)).sum::<f64>() / 30.0;
        assert!(skew(&standard) > 1.0 && skew(&values).abs() < 0.5);
        assert!(warp.slope > 0.0 && warp.slope.is_finite());
    }

    #[test]
    fn values_that_do_not_differ_are_left_to_the_caller() {
        for values in [&[0.0; 5][..], &[f64::NAN, 1.0]] {
            assert!(warp(values, values).is_none());
        }
    }
}
