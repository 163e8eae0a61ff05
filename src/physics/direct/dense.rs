//! Small dense symmetric systems, row by row in a slice. Every inner loop runs
//! along a row without carrying a sum, so that it needs not wait for the last addition.

use super::blocks::Vector6;

/// `result = matrix * vector` for a symmetric matrix with both halves.
pub(super) fn multiply(matrix: &[f64], vector: &[Vector6], result: &mut [Vector6]) {
    result.fill(Vector6::zeros());
    let n = 6 * vector.len();
    if n == 0 {
        return;
    }
    // The rows serve as columns.
    let factors = vector.iter().flat_map(|part| part.iter());
    for (row, factor) in matrix.chunks_exact(n).zip(factors) {
        for (part, to) in row.chunks_exact(6).zip(&mut *result) {
            for c in 0..6 {
                to[c] += part[c] * factor;
            }
        }
    }
}

/// Cholesky factorisation `U^T U` in place of the upper half, the diagonal
/// holding the reciprocals of `U`'s; None if the matrix is not positive definite
/// (or not finite).
pub(super) fn factor(matrix: &mut [f64], n: usize) -> Option<()> {
    for k in 0..n {
        let (done, rest) = matrix.split_at_mut((k + 1) * n);
        let row = &mut done[k * n + k..];
        if row[0].is_nan() || row[0] <= 0.0 {
            return None;
        }
        let scale = 1.0 / row[0].sqrt();
        row[0] = scale;
        for value in &mut row[1..] {
            *value *= scale;
        }
        for (i, below) in rest.chunks_exact_mut(n).enumerate() {
            let from = &row[1 + i..];
            let factor = from[0];
            for (to, value) in below[k + 1 + i..].iter_mut().zip(from) {
                *to -= factor * value;
            }
        }
    }
    Some(())
}

/// Solves with the factor, in place.
pub(super) fn solve(factor: &[f64], vector: &mut [f64]) {
    let n = vector.len();
    for k in 0..n {
        let (done, rest) = vector.split_at_mut(k + 1);
        let row = &factor[k * n + k..(k + 1) * n];
        done[k] *= row[0];
        for (to, value) in rest.iter_mut().zip(&row[1..]) {
            *to -= done[k] * value;
        }
    }
    for k in (0..n).rev() {
        let row = &factor[k * n + k..(k + 1) * n];
        let sum: f64 = row[1..].iter().zip(&vector[k + 1..]).map(|(a, b)| a * b).sum();
        vector[k] = (vector[k] - sum) * row[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn factor_and_solution_undo_the_product() {
        let side = DMatrix::from_fn(12, 12, |r, c| ((1 + 5 * r + 3 * c) as f64).sin());
        let whole = &side * side.transpose() + DMatrix::identity(12, 12);
        let wanted: Vec<Vector6> =
            (0..2).map(|i| Vector6::from_fn(|r, _| (6 * i + r) as f64 - 4.0)).collect();
        let mut product = vec![Vector6::zeros(); 2];
        multiply(whole.as_slice(), &wanted, &mut product);
        let flat = |parts: &[Vector6]| DVector::from_fn(12, |i, _| parts[i / 6][i % 6]);
        assert!((&whole * flat(&wanted) - flat(&product)).norm() < 1e-12);
        let mut square = whole.as_slice().to_vec();
        factor(&mut square, 12).expect("positive definite");
        let mut solved = flat(&product);
        solve(&square, solved.as_mut_slice());
        assert!((solved - flat(&wanted)).norm() < 1e-9);
        assert!(factor(&mut vec![-1.0; 36], 6).is_none());
    }
}
