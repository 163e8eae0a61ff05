//! Gaussian process with a linear mean, for any kernel.
//!
//! In the notation of Rasmussen and Williams 2006, Gaussian Processes for Machine Learning: values
//! `y = f(X) + H' beta + noise`, where `f` is a process of mean 0, `K` is the covariance of the
//! values (kernel and noise), and column `i` of `H` holds the `P` terms of the mean at point `i`.
//! The prior of the coefficients is flat (section 2.7), so that
//!
//! ```text
//! A = H K^-1 H'                          precision matrix of beta
//! beta = A^-1 H K^-1 y                   generalised least squares
//! alpha = K^-1 (y - H' beta)             weights
//! mean = h' beta + k' alpha              (2.42)
//! variance = k(x, x) - k' K^-1 k + r' A^-1 r,  r = h - H K^-1 k
//! ```
//!
//! at a point of terms `h`, covariances `k` with the values and variance `k(x, x)`. Without terms
//! (`P = 0`) these are (2.25) and (2.26), the predictions of section 2.2; with the one term 1 they
//! are ordinary kriging. Coefficients with a normal prior belong in the kernel (2.40).
//!
//! Two likelihoods choose a kernel (section 5.4.1):
//! [`log_likelihood`](Process::log_likelihood), over which the coefficients are integrated out
//! (2.45), and [`profile_log_likelihood`](Process::profile_log_likelihood), which is maximised over
//! the coefficients and a common scale of `K`.
//!
//! ```
//! use ask_tell::process::{Process, matern52};
//! use nalgebra::{DMatrix, DVector};
//!
//! // Values of 2 x + sin(x), modelled as a line plus a process of length scale 2 and variance 1.
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
#[cfg(test)]
mod tests;

pub use kernel::{distance2, matern52, matern52_slope};

use factor::{Factor, factor, solve_lower, with_point};
use mean::LinearMean;
use nalgebra::{DMatrix, DVector};

/// A Gaussian process conditioned on values, its mean a sum of `P` terms.
#[derive(Debug, Clone)]
pub struct Process<const P: usize> {
    /// The terms at the points, by term: `H'`.
    terms: [DVector<f64>; P],
    pub(crate) factor: Factor,
    pub(crate) mean: LinearMean<P>,
    coefficients: [f64; P],
    /// `K^-1 (y - H' beta)`; 0 for posterior means treated as observations.
    weights: DVector<f64>,
    /// `(y - H' beta)' K^-1 (y - H' beta)`.
    quadratic: f64,
}

impl<const P: usize> Process<P> {
    /// Conditions a process on `values` with their covariance, of which only the lower triangle is
    /// read, and the terms of the mean at each of their points. Without values the mean is 0.
    ///
    /// `None` if the numbers of rows, columns, terms and values are not the same, if the
    /// covariance is not positive definite to working precision, if the values do not determine
    /// the coefficients, or if a value is not finite.
    pub fn new(covariance: DMatrix<f64>, terms: &[[f64; P]], values: &[f64]) -> Option<Self> {
        let n = values.len();
        if covariance.shape() != (n, n) || terms.len() != n {
            return None;
        }
        let factor = factor(covariance)?;
        let column = |p: usize| DVector::from_iterator(n, terms.iter().map(|h| h[p]));
        let terms: [_; P] = std::array::from_fn(column);
        let mean = LinearMean::new(&factor, &terms);
        if n > 0 && !mean.determined {
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

    /// Returns the number of observations and of posterior means treated as such.
    pub(crate) fn len(&self) -> usize {
        self.weights.len()
    }

    /// Returns the mean at a point; `k` are its covariances with the values, `h` its terms.
    pub fn mean(&self, k: &DVector<f64>, h: &[f64; P]) -> f64 {
        h.iter().zip(&self.coefficients).map(|(h, b)| h * b).sum::<f64>() + k.dot(&self.weights)
    }

    /// Returns the variance, without noise, at a point; `k` are its covariances with the values, `h` its terms, and
    /// `prior` is its variance `k(x, x)` by the kernel. The variance due to the coefficients is included.
    pub fn variance(&self, k: &DVector<f64>, h: &[f64; P], prior: f64) -> f64 {
        self.variance_of(k, h, prior, &solve_lower(&self.factor, k))
    }

    /// Returns the same as [`variance`](Self::variance), given `half` = `L^-1 k`.
    pub(crate) fn variance_of(
        &self,
        k: &DVector<f64>,
        h: &[f64; P],
        prior: f64,
        half: &DVector<f64>,
    ) -> f64 {
        (prior - half.norm_squared()).max(0.0) + self.mean.variance(k, h)
    }

    /// Returns `log p(y | X)` less its constant `-(n - P) / 2 log(2 pi)`, the coefficients integrated out.
    pub fn log_likelihood(&self) -> f64 {
        -0.5 * (self.quadratic + self.log_determinant() + self.mean.log_determinant())
    }

    /// Returns the largest `log p(y | X, beta, s)` over the coefficients and a common scale `s` of the
    /// covariance matrix, less a constant: `-n / 2 log((y - H' beta)' K^-1 (y - H' beta) / n) - 1/2 log |K|`.
    pub fn profile_log_likelihood(&self) -> f64 {
        let n = self.len() as f64;
        -0.5 * (n * libm::log(self.quadratic / n) + self.log_determinant())
    }

    /// Returns the unbiased estimate of a common scale of the covariance matrix,
    /// `(y - H' beta)' K^-1 (y - H' beta) / (n - P)`. It is meaningless for `P` values or fewer.
    pub fn scale(&self) -> f64 {
        self.quadratic / (self.len() as f64 - P as f64)
    }

    /// Returns `K^-1 b`; `b` has one number for each value.
    pub fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        self.factor.solve(b)
    }

    /// Returns the weights `alpha` of the covariances in the mean.
    pub fn weights(&self) -> &DVector<f64> {
        &self.weights
    }

    /// Treats the mean at a point as an observation (kriging believer): the mean is unchanged, the
    /// variance decreases. `own` is the point's variance with noise. Returns false, without a change,
    /// if the point is numerically a duplicate of another.
    pub(crate) fn believe(&mut self, k: &DVector<f64>, h: &[f64; P], own: f64) -> bool {
        let Some(factor) = with_point(&self.factor, k, own) else { return false };
        self.factor = factor;
        self.terms = std::array::from_fn(|p| self.terms[p].push(h[p]));
        self.mean = LinearMean::new(&self.factor, &self.terms);
        self.weights = self.weights.push(0.0);
        true
    }

    /// Returns `log |K|`.
    fn log_determinant(&self) -> f64 {
        self.factor.l_dirty().diagonal().iter().map(|pivot| 2.0 * libm::log(*pivot)).sum()
    }
}
