//! A Gaussian process on a linear mean, for any kernel.
//!
//! In the notation of Rasmussen and Williams 2006, Gaussian Processes for Machine Learning: values
//! `y = f(X) + H' beta + noise`, where `f` is a process of mean 0, `K` is the covariance of the
//! values (kernel and noise), and column `i` of `H` holds the `P` terms of the mean at point `i`.
//! The prior of the coefficients is flat (section 2.7), so that
//!
//! ```text
//! A = H K^-1 H'                          one over the covariance of beta
//! beta = A^-1 H K^-1 y                   generalised least squares
//! alpha = K^-1 (y - H' beta)             weights
//! mean = h' beta + k' alpha              (2.42)
//! variance = k(x, x) - k' K^-1 k + r' A^-1 r,  r = h - H K^-1 k
//! ```
//!
//! at a point of terms `h`, covariances `k` with the values and variance `k(x, x)`. Without terms
//! (`P = 0`) these are (2.25) and (2.26), the predictions of section 2.2; with the one term 1 they
//! are ordinary kriging. Coefficients with a normal prior belong into the kernel (2.40).
//!
//! Two likelihoods choose a kernel (section 5.4.1):
//! [`log_likelihood`](Process::log_likelihood), over which the coefficients are integrated out
//! (2.45), and [`profile_log_likelihood`](Process::profile_log_likelihood), which is the largest
//! over the coefficients and one factor on `K`.
//!
//! ```
//! use ask_tell::process::{Process, matern52};
//! use nalgebra::{DMatrix, DVector};
//!
//! // Values of 2 x + sin(x), a line and a process of length 2 and variance 1 about it.
//! let x: Vec<f64> = (0..9).map(f64::from).collect();
//! let y: Vec<f64> = x.iter().map(|x| 2.0 * x + x.sin()).collect();
//! let kernel = |a: f64, b: f64| matern52(((a - b) / 2.0).powi(2));
//! let noise = |i, j| if i == j { 1e-6 } else { 0.0 };
//! let covariance = DMatrix::from_fn(9, 9, |i, j| kernel(x[i], x[j]) + noise(i, j));
//! let terms: Vec<[f64; 2]> = x.iter().map(|&x| [1.0, x]).collect();
//! let process = Process::new(covariance, &terms, &y).unwrap();
//!
//! let at = 4.5;
//! let towards = DVector::from_iterator(9, x.iter().map(|&x| kernel(x, at)));
//! let mean = process.mean(&towards, &[1.0, at]);
//! let sd = process.variance(&towards, &[1.0, at], kernel(at, at)).sqrt();
//! assert!((mean - (9.0 + at.sin())).abs() < 0.05 && sd < 0.1);
//! ```

pub(crate) mod factor;
mod kernel;
mod mean;

pub use kernel::{distance2, exp_minus, matern52, matern52_slope};

use factor::{Factor, factor, half_solved, with_point};
use mean::LinearMean;
use nalgebra::{DMatrix, DVector};

/// A Gaussian process conditioned on values, its mean a sum of `P` terms.
#[derive(Debug, Clone)]
pub struct Process<const P: usize> {
    /// The terms at the points, by term: `H'`.
    terms: [DVector<f64>; P],
    factor: Factor,
    mean: LinearMean<P>,
    coefficients: [f64; P],
    /// `K^-1 (y - H' beta)`; 0 for believed points.
    weights: DVector<f64>,
    /// `(y - H' beta)' K^-1 (y - H' beta)`.
    quadratic: f64,
}

impl<const P: usize> Process<P> {
    /// Conditions on `values` of this covariance, of which only the lower triangle is read, each
    /// with the mean's terms at its point. Without values the mean is 0.
    ///
    /// `None` if the numbers of rows, columns, terms and values are not the same, if the
    /// covariance is not positive definite to working precision, if the values do not tell the
    /// coefficients apart, or if a value is not finite.
    pub fn new(covariance: DMatrix<f64>, terms: &[[f64; P]], values: &[f64]) -> Option<Self> {
        let n = values.len();
        if covariance.shape() != (n, n) || terms.len() != n {
            return None;
        }
        let factor = factor(covariance)?;
        let column = |p: usize| DVector::from_iterator(n, terms.iter().map(|h| h[p]));
        let terms: [_; P] = std::array::from_fn(column);
        let mean = LinearMean::new(&factor, &terms);
        if n > 0 && !mean.told {
            return None;
        }
        let y = DVector::from_column_slice(values);
        let coefficients = mean.coefficients(&y);
        let of_mean =
            |i: usize| -> f64 { terms.iter().zip(&coefficients).map(|(h, b)| h[i] * b).sum() };
        let residual = DVector::from_fn(n, |i, _| y[i] - of_mean(i));
        let weights = factor.solve(&residual);
        let quadratic = weights.dot(&residual);
        let process = Process { terms, factor, mean, coefficients, weights, quadratic };
        quadratic.is_finite().then_some(process)
    }

    /// Values and believed points together.
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// Whether it is conditioned on nothing.
    pub fn is_empty(&self) -> bool {
        self.weights.is_empty()
    }

    /// Mean at a point of covariances `k`, as many as [`len`](Self::len), and terms `h`.
    pub fn mean(&self, k: &DVector<f64>, h: &[f64; P]) -> f64 {
        h.iter().zip(&self.coefficients).map(|(h, b)| h * b).sum::<f64>() + k.dot(&self.weights)
    }

    /// Variance, without noise, at a point of covariances `k`, terms `h` and this prior variance;
    /// it holds that of the coefficients.
    pub fn variance(&self, k: &DVector<f64>, h: &[f64; P], prior: f64) -> f64 {
        self.variance_of(k, h, prior, &half_solved(&self.factor, k))
    }

    /// The same with `L^-1 k`.
    pub(crate) fn variance_of(
        &self,
        k: &DVector<f64>,
        h: &[f64; P],
        prior: f64,
        half: &DVector<f64>,
    ) -> f64 {
        (prior - half.norm_squared()).max(0.0) + self.mean.variance(k, h)
    }

    /// `log p(y | X)` less its constant `-(n - P) / 2 log(2 pi)`, the coefficients integrated out.
    pub fn log_likelihood(&self) -> f64 {
        -0.5 * (self.quadratic + self.log_determinant() + self.mean.log_determinant())
    }

    /// The largest `log p(y | X, beta, s)` over the coefficients and the factor `s` on the
    /// covariance, less a constant: `-n / 2 log((y - H' beta)' K^-1 (y - H' beta) / n) - 1/2 log |K|`.
    pub fn profile_log_likelihood(&self) -> f64 {
        let n = self.len() as f64;
        -0.5 * (n * libm::log(self.quadratic / n) + self.log_determinant())
    }

    /// The factor on the covariance that the values themselves ask for, without bias:
    /// `(y - H' beta)' K^-1 (y - H' beta) / (n - P)`. Infinite or no number of `P` values or less.
    pub fn scale(&self) -> f64 {
        self.quadratic / (self.len() as f64 - P as f64)
    }

    /// `K^-1 b`, of as many numbers as [`len`](Self::len).
    pub fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        self.factor.solve(b)
    }

    /// The weights `alpha` of the covariances in the mean.
    pub fn weights(&self) -> &DVector<f64> {
        &self.weights
    }

    /// Takes the mean at a point for observed (kriging believer): the mean stays as it is, the
    /// variance falls. `own` is the point's variance with noise. Nothing changes, and the answer is
    /// no, if the point cannot be told from those already there.
    pub(crate) fn believe(&mut self, k: &DVector<f64>, h: &[f64; P], own: f64) -> bool {
        let Some(factor) = with_point(&self.factor, k, own) else { return false };
        self.factor = factor;
        self.terms = std::array::from_fn(|p| self.terms[p].push(h[p]));
        self.mean = LinearMean::new(&self.factor, &self.terms);
        self.weights = self.weights.push(0.0);
        true
    }

    pub(crate) fn factor(&self) -> &Factor {
        &self.factor
    }

    pub(crate) fn linear_mean(&self) -> &LinearMean<P> {
        &self.mean
    }

    /// `log |K|`.
    fn log_determinant(&self) -> f64 {
        self.factor.l_dirty().diagonal().iter().map(|pivot| 2.0 * libm::log(*pivot)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: [f64; 7] = [0.0, 0.4, 1.1, 1.5, 2.3, 2.9, 3.6];
    const AT: f64 = 1.9;

    fn kernel(a: f64, b: f64) -> f64 {
        0.7 * matern52(((a - b) / 0.8).powi(2))
    }

    /// Covariance of the values, with noise and a normal prior of this variance of both terms.
    fn covariance(prior: f64) -> DMatrix<f64> {
        let noise = |i, j| if i == j { 0.01 } else { 0.0 };
        DMatrix::from_fn(7, 7, |i, j| {
            kernel(X[i], X[j]) + noise(i, j) + prior * (1.0 + X[i] * X[j])
        })
    }

    fn towards(prior: f64) -> DVector<f64> {
        DVector::from_iterator(7, X.iter().map(|&x| kernel(x, AT) + prior * (1.0 + x * AT)))
    }

    fn values() -> [f64; 7] {
        X.map(|x| 3.0 - 2.0 * x + (2.0 * x).sin())
    }

    #[test]
    fn a_flat_prior_is_the_limit_of_a_wide_one() {
        let flat = Process::new(covariance(0.0), &X.map(|x| [1.0, x]), &values()).unwrap();
        let wide = Process::new(covariance(1e6), &[[]; 7], &values()).unwrap();
        let (k, h, prior) = (towards(1e6), [1.0, AT], 0.7 + 1e6 * (1.0 + AT * AT));
        let (mean, variance) = (wide.mean(&k, &[]), wide.variance(&k, &[], prior));
        assert!((flat.mean(&towards(0.0), &h) - mean).abs() < 1e-5);
        assert!((flat.variance(&towards(0.0), &h, 0.7) - variance).abs() < 1e-5);
        // (2.43) and (2.45): but for log |B| the wide likelihood becomes the flat one.
        let difference = wide.log_likelihood() + 0.5 * libm::log(1e6 * 1e6);
        assert!((flat.log_likelihood() - difference).abs() < 1e-4);
    }

    #[test]
    fn the_profile_is_the_largest_likelihood_over_scale_and_coefficients() {
        let (n, y) = (7.0, DVector::from_row_slice(&values()));
        let process = Process::new(covariance(0.0), &X.map(|x| [1.0, x]), &values()).unwrap();
        let inverse = covariance(0.0).try_inverse().unwrap();
        let log_determinant = libm::log(covariance(0.0).determinant());
        let likelihood = |a: f64, b: f64, scale: f64| {
            let rest = DVector::from_fn(7, |i, _| y[i] - a - b * X[i]);
            let quadratic = rest.dot(&(&inverse * &rest)) / scale;
            -0.5 * (quadratic + n * libm::log(scale) + log_determinant - n)
        };
        let ([a, b], scale) = (process.coefficients, process.scale() * 5.0 / n);
        let most = process.profile_log_likelihood();
        assert!((likelihood(a, b, scale) - most).abs() < 1e-9);
        for step in [-0.01, 0.01] {
            assert!(likelihood(a + step, b, scale) < most);
            assert!(likelihood(a, b + step, scale) < most);
            assert!(likelihood(a, b, scale * (1.0 + step)) < most);
        }
    }

    #[test]
    fn what_cannot_be_conditioned_on_is_refused() {
        let alike = X.map(|_| [1.0, 3.0]);
        assert!(Process::new(covariance(0.0), &alike, &values()).is_none());
        assert!(Process::new(covariance(0.0), &alike[..6], &values()).is_none());
        assert!(Process::new(covariance(0.0), &X.map(|x| [x]), &[f64::NAN; 7]).is_none());
        assert!(Process::new(-covariance(0.0), &X.map(|x| [x]), &values()).is_none());
        assert!(Process::<1>::new(DMatrix::zeros(0, 0), &[], &[]).is_some_and(|p| p.is_empty()));
    }
}
