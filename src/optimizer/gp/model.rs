//! The trained Gaussian process.

use super::kernel::{Hyperparameters, matern52};
use super::likelihood::Drift;
use super::linalg::{Cholesky, dot, offset};

/// A Gaussian process conditioned on observations. Inputs in the unit cube, outputs in the
/// units of the training values.
#[derive(Debug, Clone)]
pub struct Gp {
    theta: Hyperparameters,
    /// One over each length scale.
    inverse_length: Vec<f64>,
    signal: f64,
    noise: f64,
    mean: f64,
    /// Scaled inputs by axis: `columns[a][i]` is coordinate `a` of observation `i`.
    columns: Vec<Vec<f64>>,
    factor: Cholesky,
    /// `K^-1 (y - mean)`; zero for believed points.
    alpha: Vec<f64>,
    /// What is known of the mean.
    drift: Drift,
}

/// What a candidate's covariances tell before any triangular solve.
pub(super) struct Glance {
    /// Posterior mean.
    pub mean: f64,
    /// A bound on the posterior variance: that given the most correlated observation alone,
    /// and that of the mean.
    pub variance_bound: f64,
}

impl Gp {
    /// Conditions on `y` at `x`. Should the covariance not be positive definite, the noise is
    /// raised until it is; `None` if even that does not help (values that are not finite).
    pub fn new(
        x: &[Vec<f64>],
        y: &[f64],
        noise_floor: f64,
        theta: Hyperparameters,
    ) -> Option<Self> {
        let signal = libm::exp(theta.log_signal);
        let scaled: Vec<Vec<f64>> = x.iter().map(|p| theta.scale(p)).collect();
        let axes = theta.log_length.len();
        let columns: Vec<Vec<f64>> =
            (0..axes).map(|a| scaled.iter().map(|p| p[a]).collect()).collect();
        let mut noise = noise_floor + libm::exp(theta.log_noise);
        let mut gp = Gp {
            inverse_length: theta.log_length.iter().map(|l| libm::exp(-l)).collect(),
            theta,
            signal,
            noise,
            mean: 0.0,
            columns,
            factor: Cholesky::default(),
            alpha: Vec::new(),
            drift: Drift::default(),
        };
        let mut packed = Vec::with_capacity(offset(y.len()));
        let mut row = Vec::new();
        for (i, point) in scaled.iter().enumerate() {
            gp.covariances(point, i + 1, &mut row);
            packed.extend_from_slice(&row);
        }
        for _ in 0..8 {
            let mut noisy = packed.clone();
            (0..y.len()).for_each(|i| noisy[offset(i) + i] += noise);
            if let Some(factor) = Cholesky::new(&noisy, y.len()) {
                gp.drift = Drift::new(&factor, y.len());
                (gp.mean, gp.alpha) = gp.drift.residual(&factor, y);
                (gp.factor, gp.noise) = (factor, noise);
                let finite = gp.mean.is_finite() && gp.alpha.iter().all(|a| a.is_finite());
                return finite.then_some(gp);
            }
            noise = (noise * 10.0).max(1e-8 * signal);
        }
        None
    }

    /// Observations and believed points together.
    pub fn len(&self) -> usize {
        self.alpha.len()
    }

    /// Whether it is conditioned on nothing.
    pub fn is_empty(&self) -> bool {
        self.alpha.is_empty()
    }

    /// The hyperparameters.
    pub fn hyperparameters(&self) -> &Hyperparameters {
        &self.theta
    }

    /// Posterior mean and variance of the function (without noise) at a point; the variance
    /// holds that of the constant mean (ordinary kriging).
    pub fn predict(&self, x: &[f64]) -> (f64, f64) {
        let mut k = Vec::new();
        self.covariances(&self.scale(x), self.len(), &mut k);
        let v = self.factor.forward(&k);
        let variance = (self.signal - dot(&v, &v)).max(0.0) + self.drift.variance(&k);
        (self.mean + dot(&k, &self.alpha), variance)
    }

    /// Takes the posterior mean at `x` for observed (kriging believer). The mean stays as it is,
    /// the variance falls. Nothing changes if `x` cannot be told from points already there.
    pub fn believe(&mut self, x: &[f64]) {
        let scaled = self.scale(x);
        let mut k = Vec::new();
        self.covariances(&scaled, self.len(), &mut k);
        if self.factor.append(&k, self.signal + self.noise) {
            self.columns.iter_mut().zip(&scaled).for_each(|(c, x)| c.push(*x));
            self.alpha.push(0.0);
            self.drift = Drift::new(&self.factor, self.alpha.len());
        }
    }

    /// Posterior mean and a bound of the variance from the covariances `k` of a candidate.
    pub(super) fn glance(&self, k: &[f64]) -> Glance {
        let largest = k.iter().copied().fold(0.0, f64::max);
        let alone = self.signal - largest * largest / (self.signal + self.noise);
        Glance {
            mean: self.mean + dot(k, &self.alpha),
            variance_bound: alone + self.drift.variance(k),
        }
    }

    /// Posterior variance from the covariances `k`, or `None` as soon as `hopeless` says of an
    /// upper bound that it is too small to matter.
    pub(super) fn variance(&self, k: &[f64], hopeless: impl Fn(f64) -> bool) -> Option<f64> {
        const BLOCK: usize = 32;
        let mut v: Vec<f64> = Vec::with_capacity(k.len());
        let drift = self.drift.variance(k);
        let mut variance = self.signal;
        for (i, &b) in k.iter().enumerate() {
            let next = self.factor.forward_step(&v, b);
            variance -= next * next;
            v.push(next);
            if i % BLOCK == BLOCK - 1 && hopeless(variance.max(0.0) + drift) {
                return None;
            }
        }
        Some(variance.max(0.0) + drift)
    }

    /// Covariances of a candidate of the unit cube with all observations.
    pub(super) fn cross(&self, x: &[f64], k: &mut Vec<f64>) {
        self.covariances(&self.scale(x), self.len(), k);
    }

    fn scale(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.inverse_length).map(|(x, i)| x * i).collect()
    }

    /// Covariances of a scaled point with the first `n` observations.
    fn covariances(&self, scaled: &[f64], n: usize, k: &mut Vec<f64>) {
        k.clear();
        k.resize(n, 0.0);
        for (column, x) in self.columns.iter().zip(scaled) {
            k.iter_mut().zip(column).for_each(|(r2, c)| *r2 += (c - x) * (c - x));
        }
        k.iter_mut().for_each(|r2| *r2 = self.signal * matern52(*r2));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn theta() -> Hyperparameters {
        Hyperparameters { log_length: vec![-1.0], log_signal: 0.0, log_noise: -30.0 }
    }

    fn model() -> Gp {
        let x: Vec<Vec<f64>> = (0..9).map(|i| vec![f64::from(i) / 8.0]).collect();
        let y: Vec<f64> = x.iter().map(|p| (6.0 * p[0]).sin()).collect();
        Gp::new(&x, &y, 1e-8, theta()).unwrap()
    }

    #[test]
    fn one_observation_is_worked_by_hand() {
        let theta = Hyperparameters { log_length: vec![0.0], ..theta() };
        let gp = Gp::new(&[vec![0.0]], &[2.0], 0.5, theta).unwrap();
        // The constant mean takes the value, with a variance of 1.5; that of the rest is
        // 1 - k^2 / 1.5, and k / 1.5 of the mean is known from the value itself.
        let (mean, variance) = gp.predict(&[1.0]);
        let k = matern52(1.0);
        let expected = 1.0 - k * k / 1.5 + 1.5 * (1.0 - k / 1.5).powi(2);
        assert!((mean - 2.0).abs() < 1e-12);
        assert!((variance - expected).abs() < 1e-12);
        // Far off nothing is known but that the value was drawn about the same mean.
        assert!((gp.predict(&[99.0]).1 - 2.5).abs() < 1e-12);
    }

    #[test]
    fn a_smooth_function_is_interpolated() {
        let gp = model();
        for k in 0..=80 {
            let x = f64::from(k) / 80.0;
            let (mean, variance) = gp.predict(&[x]);
            assert!((mean - (6.0 * x).sin()).abs() < 0.05, "at {x}");
            assert!((0.0..0.05).contains(&variance));
        }
        assert!(gp.predict(&[0.5]).1 < 1e-6);
    }

    #[test]
    fn believing_keeps_the_mean_and_lowers_the_variance() {
        let mut gp = model();
        let before: Vec<_> = [0.06, 0.3, 0.94].iter().map(|&x| gp.predict(&[x])).collect();
        gp.believe(&[0.06]);
        gp.believe(&[0.06]);
        for (x, (mean, variance)) in [0.06, 0.3, 0.94].into_iter().zip(before) {
            let after = gp.predict(&[x]);
            assert!((after.0 - mean).abs() < 1e-9 && after.1 <= variance + 1e-12);
        }
        assert!(gp.predict(&[0.06]).1 < 1e-6);
    }

    #[test]
    fn the_glance_bounds_the_variance() {
        let gp = model();
        let mut k = Vec::new();
        for x in [0.03, 0.2, 0.77, 1.0] {
            gp.cross(&[x], &mut k);
            let (mean, variance) = gp.predict(&[x]);
            let glance = gp.glance(&k);
            assert!((glance.mean - mean).abs() < 1e-12 && glance.variance_bound >= variance);
            assert!((gp.variance(&k, |_| false).unwrap() - variance).abs() < 1e-12);
        }
    }

    #[test]
    fn duplicates_are_survived_and_nan_is_refused() {
        let x = vec![vec![0.5]; 6];
        assert!(Gp::new(&x, &[1.0, 2.0, 1.0, 2.0, 0.0, 1.0], 0.0, theta()).is_some());
        assert!(Gp::new(&x, &[f64::NAN; 6], 1e-8, theta()).is_none());
        assert!(Gp::new(&[], &[], 1e-8, theta()).is_some_and(|gp| gp.is_empty()));
    }
}
