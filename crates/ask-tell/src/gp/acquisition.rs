//! Log expected improvement, computed so that it neither underflows nor cancels.

use crate::pareto::Cell;
use crate::statistics::{normal_cdf, normal_log_cdf, normal_log_pdf};
use libm::{exp, expm1, log};

/// Smallest argument of the direct formula, which loses digits below it.
const MIN_DIRECT: f64 = -1.5;

/// Returns `log E max(f - best, 0)` for `f` normal with that mean and standard deviation:
/// `log_h((mean - best) / std) + log(std)`. Minus infinity in place of NaN.
pub(super) fn log_expected_improvement(mean: f64, std: f64, best: f64) -> f64 {
    let value =
        if std > 0.0 { log_h((mean - best) / std) + log(std) } else { log((mean - best).max(0.0)) };
    if value.is_nan() { f64::NEG_INFINITY } else { value }
}

/// Returns `log(phi(z) + z Phi(z))`, with phi and Phi the standard normal density and distribution.
///
/// For `z > -1.5` it is evaluated directly. Below, with Mills' ratio `R(x) = Phi(-x) / phi(x)` at `x = -z`,
/// it is `log phi(x) + log(1 - x R(x))`. Laplace's continued fraction
/// `R(x) = 1 / (x + K)`, `K = 1 / (x + 2 / (x + 3 / (x + ...)))`, turns the difference
/// into `K / (x + K)`: nothing cancels, down to `z = -1e150`.
fn log_h(z: f64) -> f64 {
    let log_density = normal_log_pdf(z);
    if z > MIN_DIRECT {
        return log(exp(log_density) + z * normal_cdf(z));
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

/// Returns the log of the probability that a normal random variable with that mean and standard deviation
/// is at least `threshold`.
pub(super) fn log_probability_above(mean: f64, std: f64, threshold: f64) -> f64 {
    if std > 0.0 {
        return normal_log_cdf((mean - threshold) / std);
    }
    if mean >= threshold { 0.0 } else { f64::NEG_INFINITY }
}

/// Returns the log of the expected hypervolume improvement (Emmerich et al. 2011, CEC, doi
/// 10.1109/CEC.2011.5949880) of a normal vector with independent components; `moments` are the mean and standard
/// deviation of each, and `cells` are disjoint boxes that cover the non-dominated region.
///
/// Within one cell the components are independent, and the length of `[low, min(f, high)]` is
/// the improvement over `low` minus that over `high`: so the expectation is a sum over the cells
/// of products of differences of expected improvements, all taken in logarithms.
pub(super) fn log_expected_volume(moments: &[(f64, f64)], cells: &[Cell]) -> f64 {
    let side = |(&(mean, std), (&low, &high)): (&(f64, f64), (&f64, &f64))| {
        let whole = log_expected_improvement(mean, std, low);
        if high == f64::INFINITY || whole == f64::NEG_INFINITY {
            return whole;
        }
        let beyond = log_expected_improvement(mean, std, high);
        whole + log(-expm1((beyond - whole).min(0.0)))
    };
    let volume = |cell: &Cell| -> f64 {
        moments.iter().zip(cell.low.iter().zip(&cell.high)).map(side).sum()
    };
    let logs: Vec<f64> = cells.iter().map(volume).collect();
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return largest;
    }
    largest + log(logs.iter().map(|log| exp(log - largest)).sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal::StandardNormal;
    use crate::pareto::{hypervolume, undominated};
    use crate::stream::stream;
    use rand::RngExt;

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
    fn log_h_matches_high_precision_values() {
        for (z, expected) in LOG_H_REFERENCE {
            let error = (log_h(z) - expected).abs() / expected.abs().max(1e-3);
            assert!(error < 2e-13, "log_h({z}) = {}, not {expected}", log_h(z));
        }
    }

    #[test]
    fn log_h_increases_strictly() {
        let mut last = f64::NEG_INFINITY;
        for k in -40_000..4_000 {
            let value = log_h(f64::from(k) * 0.01);
            assert!(value > last, "at {k}");
            last = value;
        }
    }

    #[test]
    fn without_deviation_the_improvement_is_certain() {
        assert!((log_expected_improvement(3.0, 0.0, 1.0) - libm::log(2.0)).abs() < 1e-15);
        assert_eq!(log_expected_improvement(0.0, 0.0, 1.0), f64::NEG_INFINITY);
        assert_eq!(log_expected_improvement(f64::NAN, 1.0, 1.0), f64::NEG_INFINITY);
        assert!(log_expected_improvement(-1e9, 1.0, 0.0).is_finite());
    }

    #[test]
    fn without_deviation_the_probability_is_zero_or_one() {
        assert_eq!(log_probability_above(1.0, 0.0, 1.0), 0.0);
        assert_eq!(log_probability_above(0.9, 0.0, 1.0), f64::NEG_INFINITY);
    }

    #[test]
    fn the_expected_volume_matches_a_monte_carlo_mean() {
        for (front, moments) in [
            (vec![vec![1.0, 3.0], vec![2.0, 2.0]], vec![(1.8, 0.7), (2.4, 0.5)]),
            (vec![], vec![(0.5, 1.0), (0.3, 0.2)]),
            (
                vec![vec![1.0, 1.0, 2.0], vec![2.0, 1.5, 0.5]],
                vec![(1.2, 0.6), (1.4, 0.4), (1.1, 0.9)],
            ),
        ] {
            let reference = vec![0.0; moments.len()];
            let cells = undominated(&front, &reference);
            let before = hypervolume(&front, &reference);
            let mut random = stream(0, moments.len() as u64, "volume test");
            let draws = 40_000;
            let mut sum = 0.0;
            for _ in 0..draws {
                let drawn = moments
                    .iter()
                    .map(|(mean, std)| mean + std * random.sample::<f64, _>(StandardNormal));
                let with = [front.clone(), vec![drawn.collect()]].concat();
                sum += hypervolume(&with, &reference) - before;
            }
            let (found, expected) =
                (exp(log_expected_volume(&moments, &cells)), sum / draws as f64);
            assert!((found / expected - 1.0).abs() < 0.03, "{found} and {expected}");
        }
    }

    #[test]
    fn a_hopeless_vector_still_has_a_finite_logarithm() {
        let cells = undominated(&[vec![1.0, 1.0]], &[0.0, 0.0]);
        let near = log_expected_volume(&[(-20.0, 0.1), (-20.0, 0.1)], &cells);
        let far = log_expected_volume(&[(-30.0, 0.1), (-20.0, 0.1)], &cells);
        assert!(near.is_finite() && far < near, "{near} and {far}");
    }
}
