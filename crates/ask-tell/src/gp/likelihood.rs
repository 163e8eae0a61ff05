//! Log posterior of the hyperparameters and its gradient.

use super::hyperparameters::Hyperparameters;
use crate::process::factor::inverse;
use crate::process::{Process, distance2, matern52, matern52_slope};
use nalgebra::DMatrix;

/// Returns mean and standard deviation of the normal prior of each log hyperparameter, in the order of
/// [`Hyperparameters::to_vec`].
///
/// Length scales: log-normal prior of Hvarfner et al. 2024 (arXiv 2402.02229), whose median grows with the
/// square root of the dimension. The fit maximises the density of the length scale rather than of its logarithm,
/// so the mean here is the logarithm of the mode. Signal and noise variance: wide priors around 1 and 1e-4 times
/// the variance of the data.
pub(super) fn priors(dimension: usize) -> Vec<(f64, f64)> {
    let length = std::f64::consts::SQRT_2 - 3.0 + 0.5 * libm::log(dimension.max(1) as f64);
    let mut priors = vec![(length, 3f64.sqrt()); dimension];
    priors.extend([(0.0, 1.5), (-9.2, 3.0)]);
    priors
}

/// Returns the log posterior of `theta`, up to a constant, and its gradient in the order of
/// [`Hyperparameters::to_vec`], for points `x` of the unit cube with standardised values `y`;
/// `noise_floor` is a variance in the units of `y`. Returns `None` if the covariance is not positive definite.
///
/// The constant mean is integrated out under a flat prior (restricted likelihood; Rasmussen and Williams 2006,
/// section 2.7): with a plug-in least-squares mean, the model of smooth data would be overconfident in extrapolation.
pub(super) fn log_posterior(
    x: &[Vec<f64>],
    y: &[f64],
    noise_floor: f64,
    theta: &Hyperparameters,
) -> Option<(f64, Vec<f64>)> {
    let (n, d) = (y.len(), theta.log_length.len());
    let scaled: Vec<Vec<f64>> = x.iter().map(|p| theta.scale(p)).collect();
    let (signal, noise) = (libm::exp(theta.log_signal), libm::exp(theta.log_noise));
    let (mut k, mut slope) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    for j in 0..n {
        for i in j..n {
            let r2 = distance2(&scaled[i], &scaled[j]);
            k[(i, j)] = signal * matern52(r2);
            slope[(i, j)] = 2.0 * signal * matern52_slope(r2);
        }
        k[(j, j)] += noise_floor + noise;
    }
    let process = Process::new(k.clone(), &vec![[1.0]; n], y)?;
    let (alpha, [to_mean], [precision]) =
        (process.weights(), &process.mean.weights, process.mean.pivots);
    let w = to_mean / precision.max(f64::MIN_POSITIVE).sqrt();
    let mut value = process.log_likelihood();

    // d value / d theta = 1/2 sum_ij (alpha_i alpha_j + w_i w_j - (K^-1)_ij) dK_ij / d theta, with
    // alpha = K^-1 (y - mean) and w = K^-1 1 / sqrt(1' K^-1 1).
    let inverse = inverse(&process.factor);
    let mut gradient = vec![0.0; d + 2];
    let (mut through_k, mut trace) = (0.0, 0.0);
    for j in 0..n {
        let weight = |i: usize| alpha[i] * alpha[j] + w[i] * w[j] - inverse[(i, j)];
        for i in j + 1..n {
            let weight = weight(i);
            through_k += weight * k[(i, j)];
            let by_length = weight * slope[(i, j)];
            for (gradient, (a, b)) in gradient.iter_mut().zip(scaled[i].iter().zip(&scaled[j])) {
                *gradient += by_length * (a - b) * (a - b);
            }
        }
        trace += weight(j);
    }
    gradient[d] = through_k + 0.5 * trace * signal;
    gradient[d + 1] = 0.5 * trace * noise;

    for ((t, g), (mean, std)) in theta.to_vec().iter().zip(&mut gradient).zip(priors(d)) {
        let z = (t - mean) / std;
        value -= 0.5 * z * z;
        *g -= z / std;
    }
    value.is_finite().then_some((value, gradient))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data() -> (Vec<Vec<f64>>, Vec<f64>) {
        let x: Vec<Vec<f64>> = (0..14)
            .map(|i| vec![f64::from(i * 5 % 14) / 13.0, f64::from(i * 3 % 14) / 13.0])
            .collect();
        let y = x.iter().map(|p| libm::sin(5.0 * p[0]) + p[1] * p[1] - 0.4).collect();
        (x, y)
    }

    #[test]
    fn the_gradient_is_that_of_finite_differences() {
        let (x, y) = data();
        for theta in [[-1.0, 0.3, 0.2, -4.0], [-2.0, -0.5, -0.4, -9.0], [0.5, 1.0, 1.0, -1.0]] {
            let at = |theta: &[f64]| {
                log_posterior(&x, &y, 1e-4, &Hyperparameters::from_slice(theta)).unwrap()
            };
            let gradient = at(&theta).1;
            for i in 0..4 {
                let h = 1e-5;
                let (mut up, mut down) = (theta, theta);
                up[i] += h;
                down[i] -= h;
                let difference = (at(&up).0 - at(&down).0) / (2.0 * h);
                let error = (gradient[i] - difference).abs() / difference.abs().max(1.0);
                assert!(error < 1e-6, "{i}: {} and {difference}", gradient[i]);
            }
        }
    }

    #[test]
    fn the_value_is_that_of_a_two_point_process_worked_by_hand() {
        let theta = Hyperparameters { log_length: vec![0.0], log_signal: 0.0, log_noise: -40.0 };
        let x = [vec![0.0], vec![1.0]];
        let value = |y: [f64; 2]| log_posterior(&x, &y, 0.1, &theta).unwrap().0;
        // The mean of (1, -1) is 0; K = [[1.1, k], [k, 1.1]] has (1, -1) as an eigenvector.
        let k = matern52(1.0);
        let difference = value([1.0, -1.0]) - value([0.0, 0.0]);
        assert!((difference + 0.5 * 2.0 / (1.1 - k)).abs() < 1e-12, "{difference}");
    }
}
