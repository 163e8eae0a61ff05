//! Linear mean with coefficients by generalised least squares, in the notation of Rasmussen and Williams 2006,
//! section 2.7: `K` is the covariance matrix of the observations, and row `p` of `H` holds the values of term `p` at
//! their points.

use super::factor::Factor;
use nalgebra::DVector;

/// Linear mean of `P` terms: posterior precision of its coefficients with a flat prior.
#[derive(Debug, Clone)]
pub(crate) struct LinearMean<const P: usize> {
    /// `K^-1 H'`, by term.
    pub weights: [DVector<f64>; P],
    /// Rows of `L`, left of its diagonal of ones, in the factorisation `A = H K^-1 H' = L D L'` of the precision
    /// matrix of the coefficients.
    lower: [[f64; P]; P],
    /// `D`; 0 for coefficients that the values do not determine.
    pub pivots: [f64; P],
    /// Whether the values determine all coefficients.
    pub determined: bool,
}

/// Smallest pivot relative to the diagonal element; smaller ones are dominated by rounding errors.
const MIN_RELATIVE_PIVOT: f64 = 1e-9;

impl<const P: usize> LinearMean<P> {
    /// Factorises `A` for terms whose values at the points are the columns of `H'`.
    pub fn new(factor: &Factor, terms: &[DVector<f64>; P]) -> Self {
        let weights: [_; P] = std::array::from_fn(|p| factor.solve(&terms[p]));
        let product = |i: usize, j: usize| -> f64 {
            terms[i].iter().zip(&weights[j]).map(|(h, w)| h * w).sum()
        };
        let (mut lower, mut pivots, mut determined) = ([[0.0; P]; P], [0.0; P], true);
        for i in 0..P {
            for j in 0..=i {
                let known: f64 = (0..j).map(|m| lower[i][m] * lower[j][m] * pivots[m]).sum();
                let whole = product(i, j);
                if i > j {
                    lower[i][j] = quotient(whole - known, pivots[j]);
                } else {
                    pivots[i] = (whole - known).max(0.0);
                    determined &= pivots[i] > MIN_RELATIVE_PIVOT * whole;
                }
            }
        }
        LinearMean { weights, lower, pivots, determined }
    }

    /// Returns the coefficients `A^-1 H K^-1 y`.
    pub fn coefficients(&self, y: &DVector<f64>) -> [f64; P] {
        self.solved(std::array::from_fn(|p| self.weights[p].dot(y)))
    }

    /// Returns `r' A^-1 r`, the variance due to the unknown coefficients, with the [`residual`](Self::residual) `r`.
    pub fn variance(&self, k: &DVector<f64>, h: &[f64; P]) -> f64 {
        let half = self.solve_lower(self.residual(k, h));
        let square = |(z, d): (&f64, &f64)| quotient(*z, *d) * quotient(*z, *d) * d;
        half.iter().zip(&self.pivots).map(square).sum()
    }

    /// Returns `log |A|`.
    pub fn log_determinant(&self) -> f64 {
        self.pivots.iter().map(|d| libm::log(d.max(f64::MIN_POSITIVE))).sum()
    }

    /// Returns `r = h - H K^-1 k`, for a point with terms `h` and covariances `k`.
    pub fn residual(&self, k: &DVector<f64>, h: &[f64; P]) -> [f64; P] {
        std::array::from_fn(|p| h[p] - k.dot(&self.weights[p]))
    }

    /// Returns `L^-1 b`.
    fn solve_lower(&self, mut b: [f64; P]) -> [f64; P] {
        for i in 0..P {
            for j in 0..i {
                b[i] -= self.lower[i][j] * b[j];
            }
        }
        b
    }

    /// Returns `A^-1 b`.
    pub fn solved(&self, b: [f64; P]) -> [f64; P] {
        let half = self.solve_lower(b);
        let mut x: [f64; P] = std::array::from_fn(|i| quotient(half[i], self.pivots[i]));
        for i in (0..P).rev() {
            for j in i + 1..P {
                x[i] -= self.lower[j][i] * x[j];
            }
        }
        x
    }
}

/// Returns `a / b`; 0 if `b` is not positive.
fn quotient(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}
