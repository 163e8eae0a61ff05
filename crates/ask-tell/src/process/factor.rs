//! Cholesky factors of covariance matrices, by nalgebra.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Cholesky factorisation `K = L L'`.
pub(crate) type Factor = Cholesky<f64, Dyn>;

/// Smallest accepted square of a pivot relative to the diagonal; smaller ones are dominated by rounding.
const MIN_SQUARED_PIVOT: f64 = 1e-14;

/// Factorises a covariance matrix, reading only its lower triangle; `None` if it is not positive
/// definite to working precision.
pub(crate) fn factor(covariance: DMatrix<f64>) -> Option<Factor> {
    let diagonal = covariance.diagonal();
    let factor = Cholesky::new(covariance)?;
    let pivots = factor.l_dirty().diagonal();
    let sound = |(pivot, whole): (&f64, &f64)| pivot * pivot > MIN_SQUARED_PIVOT * whole;
    (pivots.iter().zip(&diagonal).all(sound) && pivots.sum().is_finite()).then_some(factor)
}

/// Extends the factor by one point, given its covariances with the others and its variance `own`; `None`
/// if the result is not positive definite to working precision.
pub(crate) fn with_point(factor: &Factor, covariances: &DVector<f64>, own: f64) -> Option<Factor> {
    let n = covariances.len();
    let grown = factor.insert_column(n, covariances.push(own));
    let pivot = grown.l_dirty()[(n, n)];
    (pivot * pivot > MIN_SQUARED_PIVOT * own).then_some(grown)
}

/// Returns `L^-1 b`.
pub(crate) fn solve_lower(factor: &Factor, b: &DVector<f64>) -> DVector<f64> {
    let mut x = b.clone();
    factor.l_dirty().solve_lower_triangular_unchecked_mut(&mut x);
    x
}

/// Returns the lower triangle of `K^-1`, zeros above. Takes a third of the operations of
/// [`Cholesky::inverse`], which does not exploit that the inverse of `L` is triangular.
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
