//! Gaussian process conditioned on observations.

use super::hyperparameters::Hyperparameters;
use crate::process::factor::solve_lower;
use crate::process::{Process, matern52, matern52_slope};
use nalgebra::{DMatrix, DVector};

/// Points divided by the length scales.
#[derive(Debug, Clone)]
pub(super) struct ScaledPoints {
    /// Reciprocal of each length scale.
    pub inverse_length: Vec<f64>,
    /// By axis: `columns[a][i]` is coordinate `a` of point `i`.
    columns: Vec<Vec<f64>>,
}

impl ScaledPoints {
    pub fn new(x: &[Vec<f64>], theta: &Hyperparameters) -> Self {
        let inverse_length: Vec<f64> = theta.log_length.iter().map(|l| libm::exp(-l)).collect();
        let column = |(a, i): (usize, &f64)| x.iter().map(|p| p[a] * i).collect();
        let columns = inverse_length.iter().enumerate().map(column).collect();
        ScaledPoints { inverse_length, columns }
    }

    fn scale(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.inverse_length).map(|(x, i)| x * i).collect()
    }

    pub fn push(&mut self, x: &[f64]) {
        let scaled = self.scale(x);
        self.columns.iter_mut().zip(scaled).for_each(|(column, x)| column.push(x));
    }

    /// Returns the squared distances from a point to all points.
    pub fn distances2(&self, x: &[f64]) -> Vec<f64> {
        let mut r2 = vec![0.0; self.columns.first().map_or(0, Vec::len)];
        for (column, x) in self.columns.iter().zip(self.scale(x)) {
            r2.iter_mut().zip(column).for_each(|(r2, c)| *r2 += (c - x) * (c - x));
        }
        r2
    }
}

/// Gaussian process conditioned on observations. Inputs are in the unit cube, outputs in the
/// units of the training values.
#[derive(Debug, Clone)]
pub struct Gp {
    signal: f64,
    noise: f64,
    points: ScaledPoints,
    /// Process with a constant mean.
    process: Process<1>,
}

/// Basis function of a constant mean.
const ONE: [f64; 1] = [1.0];

/// Posterior of the function (without noise) at a point, and its gradient. The variance includes
/// that of the constant mean (ordinary kriging).
pub(super) struct PosteriorGradient {
    pub mean: f64,
    pub variance: f64,
    pub mean_slope: Vec<f64>,
    pub variance_slope: Vec<f64>,
}

impl Gp {
    /// Conditions on `y` at `x`. If the covariance is not positive definite, the noise is increased
    /// until it is; `None` if that fails (values that are not finite).
    pub fn new(
        x: &[Vec<f64>],
        y: &[f64],
        noise_floor: f64,
        theta: &Hyperparameters,
    ) -> Option<Self> {
        let signal = libm::exp(theta.log_signal);
        let points = ScaledPoints::new(x, theta);
        // The lower triangle, zeros above.
        let mut covariance = DMatrix::zeros(y.len(), y.len());
        for (j, column) in covariance.as_mut_slice().chunks_exact_mut(y.len().max(1)).enumerate() {
            let lower = &mut column[j..];
            for axis in &points.columns {
                let x = axis[j];
                lower.iter_mut().zip(&axis[j..]).for_each(|(r2, c)| *r2 += (c - x) * (c - x));
            }
            lower.iter_mut().for_each(|r2| *r2 = signal * matern52(*r2));
        }
        let mut noise = noise_floor + libm::exp(theta.log_noise);
        for _ in 0..8 {
            let mut noisy = covariance.clone();
            (0..y.len()).for_each(|i| noisy[(i, i)] += noise);
            if let Some(process) = Process::new(noisy, &vec![ONE; y.len()], y) {
                return Some(Gp { signal, noise, points, process });
            }
            noise = (noise * 10.0).max(1e-8 * signal);
        }
        None
    }

    /// Returns the number of observations and of posterior means treated as such.
    pub(super) fn len(&self) -> usize {
        self.process.len()
    }

    /// Returns posterior mean and variance of the function (without noise) at a point; the variance
    /// includes that of the constant mean (ordinary kriging).
    pub fn predict(&self, x: &[f64]) -> (f64, f64) {
        let k = self.covariances(x);
        (self.process.mean(&k, &ONE), self.process.variance(&k, &ONE, self.signal))
    }

    /// Returns the posterior mean of the function at a point.
    pub fn mean(&self, x: &[f64]) -> f64 {
        self.process.mean(&self.covariances(x), &ONE)
    }

    /// Treats the posterior mean at `x` as an observation (kriging believer). The mean is unchanged
    /// and the variance decreases. No effect if `x` is numerically a duplicate of another point.
    pub(super) fn believe(&mut self, x: &[f64]) {
        let k = self.covariances(x);
        if self.process.believe(&k, &ONE, self.signal + self.noise) {
            self.points.push(x);
        }
    }

    /// Returns the posterior at a point with its gradient.
    pub(super) fn posterior_gradient(&self, x: &[f64]) -> PosteriorGradient {
        let points = &self.points;
        let r2 = points.distances2(x);
        let k = covariances(&r2, self.signal);
        let (factor, constant) = (&self.process.factor, &self.process.mean);
        let half = solve_lower(factor, &k);
        let variance = self.process.variance_of(&k, &ONE, self.signal, &half);
        let mut solved = half;
        factor.l_dirty().ad_solve_lower_triangular_unchecked_mut(&mut solved);
        // The variance is signal - k' K^-1 k + residual^2 precision.
        let [residual] = constant.solved(constant.residual(&k, &ONE));
        let [to_mean] = &constant.weights;
        let by_k = -2.0 * (solved + residual * to_mean);
        let (mut mean_slope, mut variance_slope) = (Vec::new(), Vec::new());
        for ((column, x), inverse_length) in
            points.columns.iter().zip(points.scale(x)).zip(&points.inverse_length)
        {
            let slope = |(c, r2): (&f64, &f64)| -2.0 * (x - c) * matern52_slope(*r2);
            let slope = DVector::from_iterator(self.len(), column.iter().zip(&r2).map(slope));
            mean_slope.push(self.signal * inverse_length * slope.dot(self.process.weights()));
            variance_slope.push(self.signal * inverse_length * slope.dot(&by_k));
        }
        let mean = self.process.mean(&k, &ONE);
        PosteriorGradient { mean, variance, mean_slope, variance_slope }
    }

    /// Returns the posterior mean and an upper bound on the variance that needs no triangular
    /// solve: the variance given only the most correlated observation, plus that of the mean.
    pub(super) fn bound(&self, x: &[f64]) -> (f64, f64) {
        let k = self.covariances(x);
        let largest = k.iter().copied().fold(0.0, f64::max);
        let given = self.signal - largest * largest / (self.signal + self.noise);
        (self.process.mean(&k, &ONE), given + self.process.mean.variance(&k, &ONE))
    }

    /// Returns the covariances between a point of the unit cube and all observations.
    fn covariances(&self, x: &[f64]) -> DVector<f64> {
        covariances(&self.points.distances2(x), self.signal)
    }
}

/// Returns the covariances at these squared distances.
fn covariances(r2: &[f64], signal: f64) -> DVector<f64> {
    DVector::from_iterator(r2.len(), r2.iter().map(|&r2| signal * matern52(r2)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn theta() -> Hyperparameters {
        Hyperparameters { log_length: vec![-1.0], log_signal: 0.0, log_noise: -30.0 }
    }

    fn model() -> Gp {
        let x: Vec<Vec<f64>> = (0..9).map(|i| vec![f64::from(i) / 8.0]).collect();
        let y: Vec<f64> = x.iter().map(|p| libm::sin(6.0 * p[0])).collect();
        Gp::new(&x, &y, 1e-8, &theta()).unwrap()
    }

    #[test]
    fn one_observation_matches_a_manual_calculation() {
        let theta = Hyperparameters { log_length: vec![0.0], ..theta() };
        let gp = Gp::new(&[vec![0.0]], &[2.0], 0.5, &theta).unwrap();
        // The estimated mean is the value, with a variance of 1.5, and enters with the factor 1 - k / 1.5; the
        // variance of the rest is 1 - k^2 / 1.5.
        let (mean, variance) = gp.predict(&[1.0]);
        let k = matern52(1.0);
        let expected = 1.0 - k * k / 1.5 + 1.5 * (1.0 - k / 1.5).powi(2);
        assert!((mean - 2.0).abs() < 1e-12);
        assert!((variance - expected).abs() < 1e-12);
        // Far away only the common mean is known.
        assert!((gp.predict(&[99.0]).1 - 2.5).abs() < 1e-12);
    }

    #[test]
    fn a_smooth_function_is_interpolated() {
        let gp = model();
        for k in 0..=80 {
            let x = f64::from(k) / 80.0;
            let (mean, variance) = gp.predict(&[x]);
            assert!((mean - libm::sin(6.0 * x)).abs() < 0.05, "at {x}");
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
    fn the_bound_holds_and_the_slopes_are_those_of_finite_differences() {
        let gp = model();
        for x in [0.03, 0.2, 0.77, 1.0] {
            let at = |x: f64| gp.predict(&[x]);
            let (mean, variance) = at(x);
            let bound = gp.bound(&[x]);
            assert!((bound.0 - mean).abs() < 1e-12 && bound.1 >= variance);
            let sloped = gp.posterior_gradient(&[x]);
            assert!((sloped.mean - mean).abs() < 1e-12);
            assert!((sloped.variance - variance).abs() < 1e-12);
            let (up, down) = (at(x + 1e-5), at(x - 1e-5));
            for (slope, up, down) in
                [(sloped.mean_slope[0], up.0, down.0), (sloped.variance_slope[0], up.1, down.1)]
            {
                let expected = (up - down) / 2e-5;
                let tolerance = 1e-4 * (1.0 + expected.abs());
                assert!((slope - expected).abs() < tolerance, "{slope} {expected}");
            }
        }
    }

    #[test]
    fn duplicate_points_are_accepted_and_nan_is_rejected() {
        let x = vec![vec![0.5]; 6];
        assert!(Gp::new(&x, &[1.0, 2.0, 1.0, 2.0, 0.0, 1.0], 0.0, &theta()).is_some());
        assert!(Gp::new(&x, &[f64::NAN; 6], 1e-8, &theta()).is_none());
        assert!(Gp::new(&[], &[], 1e-8, &theta()).is_some_and(|gp| gp.len() == 0));
    }
}
