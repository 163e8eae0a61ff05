//! Log expected improvement, computed so that it neither underflows nor cancels.

use libm::{erfc, exp, log};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Below this the direct formula would lose digits.
const DIRECT: f64 = -1.5;

/// `log E max(f - best, 0)` for `f` normal with that mean and standard deviation:
/// `log_h((mean - best) / std) + log(std)`. Minus infinity where it has no value.
pub fn log_expected_improvement(mean: f64, std: f64, best: f64) -> f64 {
    let value =
        if std > 0.0 { log_h((mean - best) / std) + log(std) } else { log((mean - best).max(0.0)) };
    if value.is_nan() { f64::NEG_INFINITY } else { value }
}

/// `log(phi(z) + z Phi(z))`, with phi and Phi the standard normal density and distribution.
///
/// For `z > -1.5` as it stands. Below, with Mills' ratio `R(x) = Phi(-x) / phi(x)` at `x = -z`,
/// it is `log phi(x) + log(1 - x R(x))`. Laplace's continued fraction
/// `R(x) = 1 / (x + K)`, `K = 1 / (x + 2 / (x + 3 / (x + ...)))`, turns the difference
/// into `K / (x + K)`: nothing cancels, down to `z = -1e150`.
pub fn log_h(z: f64) -> f64 {
    let log_density = -0.5 * z * z - 0.5 * log(2.0 * PI);
    if z > DIRECT {
        return log(exp(log_density) + z * 0.5 * erfc(-z * FRAC_1_SQRT_2));
    }
    let x = -z;
    if x > 1e8 {
        // K is 1 / x to the last digit, and x * x would overflow later.
        return log_density - 2.0 * log(x);
    }
    let terms = 20 + (300.0 / (x * x)) as u32;
    let mut k = 0.0;
    for numerator in (1..=terms).rev() {
        k = f64::from(numerator) / (x + k);
    }
    log_density + log(k / (x + k))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `log(phi(z) + z Phi(z))` computed with 60 digits (mpmath), rounded to doubles.
    const LOG_H_REFERENCE: [(f64, f64); 14] = [
        (3.0, 1.0987396653277077),
        (1.0, 0.08002621884930694),
        (0.25, -0.6229782309067678),
        (0.0, -0.9189385332046728),
        (-0.5, -1.6205162643873199),
        (-1.0, -2.4851210257126413),
        (-1.4375, -3.3889759266948722),
        (-1.5, -3.52993592080571),
        (-1.75, -4.124362981414742),
        (-3.0, -7.869686059603029),
        (-8.0, -37.12236426169263),
        (-40.0, -808.29856835662),
        (-1000.0, -500014.73445209116),
        (-100000000000.0, -5e21),
    ];

    #[test]
    fn high_precision_values_are_met() {
        for (z, expected) in LOG_H_REFERENCE {
            let error = (log_h(z) - expected).abs() / expected.abs().max(1e-3);
            assert!(error < 2e-13, "log_h({z}) = {}, not {expected}", log_h(z));
        }
    }

    #[test]
    fn it_rises_everywhere() {
        let mut last = f64::NEG_INFINITY;
        for k in -40_000..4_000 {
            let value = log_h(f64::from(k) * 0.01);
            assert!(value > last, "at {k}");
            last = value;
        }
    }

    #[test]
    fn no_deviation_is_the_plain_improvement() {
        assert!((log_expected_improvement(3.0, 0.0, 1.0) - 2f64.ln()).abs() < 1e-15);
        assert_eq!(log_expected_improvement(0.0, 0.0, 1.0), f64::NEG_INFINITY);
        assert_eq!(log_expected_improvement(f64::NAN, 1.0, 1.0), f64::NEG_INFINITY);
        assert!(log_expected_improvement(-1e9, 1.0, 0.0).is_finite());
    }
}
