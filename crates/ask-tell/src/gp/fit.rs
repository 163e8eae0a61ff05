//! Hyperparameters by maximum a posteriori.

use super::hyperparameters::Hyperparameters;
use super::lbfgs::{Limits, minimise};
use super::likelihood::{log_posterior, priors};

/// Computational effort of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FitEffort {
    /// Evaluations of the posterior per starting point.
    pub evaluations: usize,
    /// Whether the fixed starting points are tried in addition to those of the last fit.
    pub restarts: bool,
}

impl FitEffort {
    /// Returns the effort for `n` observations: an evaluation costs about `n^3 / 2` multiplications, and
    /// a fit should stay well below 10 ms. The fixed starting points are tried in every fit of
    /// up to 30 observations, and at every tenth observation up to 100.
    pub fn for_observations(n: usize) -> Self {
        let cost = (n * n * n / 2).max(1);
        let evaluations = (10_000_000 / cost).clamp(2, 40);
        FitEffort { evaluations, restarts: n <= 30 || (n <= 100 && n.is_multiple_of(10)) }
    }
}

/// Range of the log length scales: a hundredth of the cube's edge to thirty edges.
const LOG_LENGTH: (f64, f64) = (-4.6, 3.4);
/// Range of the log signal variance.
const LOG_SIGNAL: (f64, f64) = (-4.6, 4.6);
/// Range of the log noise variance above the floor.
const LOG_NOISE: (f64, f64) = (-18.4, 0.0);

/// Fits the hyperparameters to standardised values `y` at points `x` of the unit cube; `noise_floor` is a variance
/// in the units of `y`.
///
/// Returns the best hyperparameters found from `warm` (those of the last fit) and, if there are none or
/// `effort` requires it, from three fixed starting points: the prior's mode, short and long length
/// scales. Returns the prior's mode if every start fails. Ends soon after `stopped` returns true; the result
/// is then meaningless.
pub fn fit(
    x: &[Vec<f64>],
    y: &[f64],
    noise_floor: f64,
    warm: Option<&Hyperparameters>,
    (effort, stopped): (FitEffort, &dyn Fn() -> bool),
) -> Hyperparameters {
    let d = x.first().map_or(0, Vec::len);
    let mode: Vec<f64> = priors(d).into_iter().map(|(mean, _)| mean).collect();
    let bounds = [vec![LOG_LENGTH; d], vec![LOG_SIGNAL, LOG_NOISE]].concat();
    let (low, high): (Vec<f64>, Vec<f64>) = bounds.into_iter().unzip();
    let limits = Limits { low: &low, high: &high, evaluations: effort.evaluations };
    let mut starts: Vec<Vec<f64>> = warm.map(Hyperparameters::to_vec).into_iter().collect();
    if effort.restarts || starts.is_empty() {
        let shifted = |by: f64, noise: f64| {
            let mut start = mode.clone();
            start[..d].iter_mut().for_each(|l| *l += by);
            start[d + 1] = noise;
            start
        };
        starts.extend([mode.clone(), shifted(-1.0, -5.0), shifted(1.0, -12.0)]);
    }
    let negated = |theta: &[f64]| {
        if stopped() {
            return None;
        }
        let theta = Hyperparameters::from_slice(theta);
        let (value, gradient) = log_posterior(x, y, noise_floor, &theta)?;
        Some((-value, gradient.iter().map(|g| -g).collect()))
    };
    let found = starts.iter().filter_map(|start| minimise(negated, start, &limits));
    let best = found.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(mode, |(theta, _)| theta);
    Hyperparameters::from_slice(&best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_relevant_axis_gets_the_shorter_length_scale() {
        let x: Vec<Vec<f64>> =
            (0..40).map(|i| vec![f64::from(i) / 39.0, f64::from(i * 17 % 40) / 39.0]).collect();
        let y: Vec<f64> = x.iter().map(|p| libm::sin(9.0 * p[0]) * 1.4).collect();
        let effort = FitEffort { evaluations: 60, restarts: true };
        let theta = fit(&x, &y, 1e-8, None, (effort, &|| false));
        assert!(theta.log_length[0] + 1.0 < theta.log_length[1], "{theta:?}");
        assert!(theta.log_noise < -9.0, "{theta:?}");
    }

    #[test]
    fn degenerate_data_give_finite_hyperparameters() {
        let x = vec![vec![0.5, 0.5]; 12];
        let effort = FitEffort::for_observations(12);
        for y in [vec![0.0; 12], (0..12).map(|i| f64::from(i % 2)).collect(), vec![f64::NAN; 12]] {
            let theta = fit(&x, &y, 1e-8, None, (effort, &|| false));
            assert!(theta.to_vec().iter().all(|t| t.is_finite()));
        }
        fit(&[], &[], 1e-8, None, (effort, &|| false));
    }
}
