//! Small dense symmetric systems, row by row in a slice.

use super::blocks::Vector6;

/// `result = matrix * vector`.
pub(super) fn multiply(matrix: &[f64], vector: &[Vector6], result: &mut [Vector6]) {
    if vector.is_empty() {
        return;
    }
    let n = 6 * vector.len();
    for (i, rows) in matrix.chunks_exact(6 * n).enumerate() {
        for (r, row) in rows.chunks_exact(n).enumerate() {
            let mut sum = 0.0;
            for (part, v) in row.chunks_exact(6).zip(vector) {
                for c in 0..6 {
                    sum += part[c] * v[c];
                }
            }
            result[i][r] = sum;
        }
    }
}

/// Cholesky factorisation in place of the lower half; None if the matrix is not
/// positive definite (or not finite).
pub(super) fn factor(matrix: &mut [f64], n: usize) -> Option<()> {
    for i in 0..n {
        let (above, rest) = matrix.split_at_mut(i * n);
        let row = &mut rest[..n];
        for j in 0..i {
            let other = &above[j * n..j * n + n];
            let sum: f64 = row[..j].iter().zip(&other[..j]).map(|(a, b)| a * b).sum();
            row[j] = (row[j] - sum) / other[j];
        }
        let sum: f64 = row[..i].iter().map(|a| a * a).sum();
        let left = row[i] - sum;
        if left.is_nan() || left <= 0.0 {
            return None;
        }
        row[i] = left.sqrt();
    }
    Some(())
}

/// Solves with the factor, in place.
pub(super) fn solve(factor: &[f64], vector: &mut [Vector6]) {
    let n = 6 * vector.len();
    for i in 0..n {
        let mut sum = vector[i / 6][i % 6];
        for j in 0..i {
            sum -= factor[i * n + j] * vector[j / 6][j % 6];
        }
        vector[i / 6][i % 6] = sum / factor[i * n + i];
    }
    for i in (0..n).rev() {
        let value = vector[i / 6][i % 6] / factor[i * n + i];
        vector[i / 6][i % 6] = value;
        for j in 0..i {
            vector[j / 6][j % 6] -= factor[i * n + j] * value;
        }
    }
}
