//! Cholesky factors of covariance matrices, by nalgebra.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// `K = L L'`.
pub(crate) type Factor = Cholesky<f64, Dyn>;

/// Least pivot, as a share of the diagonal: below it rounding decides.
const LEAST_PIVOT: f64 = 1e-14;

/// Factors a covariance matrix of which only the lower triangle is read; `None` if it is not
/// positive definite to working precision.
pub(crate) fn factor(covariance: DMatrix<f64>) -> Option<Factor> {
    let diagonal = covariance.diagonal();
    let factor = Cholesky::new(covariance)?;
    let pivots = factor.l_dirty().diagonal();
    let sound = |(pivot, whole): (&f64, &f64)| pivot * pivot > LEAST_PIVOT * whole;
    (pivots.iter().zip(&diagonal).all(sound) && pivots.sum().is_finite()).then_some(factor)
}

/// The factor of one point more, of these covariances with the others and this variance.
pub(crate) fn with_point(factor: &Factor, covariances: &DVector<f64>, own: f64) -> Option<Factor> {
    let n = covariances.len();
    let grown = factor.insert_column(n, covariances.push(own));
    let pivot = grown.l_dirty()[(n, n)];
    (pivot * pivot > LEAST_PIVOT * own).then_some(grown)
}

/// `L^-1 b`.
pub(crate) fn half_solved(factor: &Factor, b: &DVector<f64>) -> DVector<f64> {
    let mut x = b.clone();
    factor.l_dirty().solve_lower_triangular_unchecked_mut(&mut x);
    x
}

/// The lower triangle of `K^-1`, zeros above. A third of the work of
/// [`Cholesky::inverse`], which does not use that the inverse of `L` is triangular, too.
pub(crate) fn inverse(factor: &Factor) -> DMatrix<f64> {
    let (l, n) = (factor.l_dirty(), factor.l_dirty().nrows());
    let mut w = DMatrix::identity(n, n);
    for j in 0..n {
        let below = l.view((j, j), (n - j, n - j));
        below.solve_lower_triangular_unchecked_mut(&mut w.view_mut((j, j), (n - j, 1)));
    }
    let mut inverse = DMatrix::zeros(n, n);
    for j in 0..n {
        for i in j..n {
            inverse[(i, j)] = w.view((i, i), (n - i, 1)).dot(&w.view((i, j), (n - i, 1)));
        }
    }
    inverse
}
