//! Small dense symmetric systems, stored row by row in blocks of six numbers. Inner loops run along a row and are
//! unrolled; each of their additions is independent of the previous one, so that they run in parallel.

/// Six consecutive numbers in a row of a matrix, or the velocity or impulse of a body.
pub(super) type Six = [f64; 6];

/// Calls a function with the number of blocks in a row, as a constant for small numbers so that its loops are unrolled.
macro_rules! unrolled {
    ($blocks:expr, $function:ident($($argument:expr),*)) => {
        match $blocks {
            1 => $function($($argument,)* 1),
            2 => $function($($argument,)* 2),
            3 => $function($($argument,)* 3),
            4 => $function($($argument,)* 4),
            blocks => $function($($argument,)* blocks),
        }
    };
}

/// Computes `to += factor * from`.
#[inline(always)]
fn add(to: &mut Six, factor: f64, from: Six) {
    for c in 0..6 {
        to[c] += factor * from[c];
    }
}

/// Computes `result = matrix * vector` for a symmetric matrix of which both halves are stored.
pub(super) fn multiply(matrix: &[Six], vector: &[Six], result: &mut [Six]) {
    unrolled!(vector.len(), multiply_unrolled(matrix, vector, result));
}

#[inline(always)]
fn multiply_unrolled(matrix: &[Six], vector: &[Six], result: &mut [Six], blocks: usize) {
    let result = &mut result[..blocks];
    result.fill([0.0; 6]);
    // The matrix is symmetric: row k is column k.
    for (k, &factor) in vector[..blocks].as_flattened().iter().enumerate() {
        let row = &matrix[k * blocks..][..blocks];
        for s in 0..blocks {
            add(&mut result[s], factor, row[s]);
        }
    }
}

/// Computes the Cholesky factorization `U^T U` of a matrix with this number of blocks in a row; returns `None` if the
/// matrix is not positive definite (or not finite). `U` replaces the upper half, except that each element of its
/// diagonal is stored as the reciprocal; the lower half is undefined afterwards.
pub(super) fn factor(matrix: &mut [Six], blocks: usize) -> Option<()> {
    unrolled!(blocks, factor_unrolled(matrix))
}

#[inline(always)]
fn factor_unrolled(matrix: &mut [Six], blocks: usize) -> Option<()> {
    for (first, at) in (0..blocks).flat_map(|first| (0..6).map(move |at| (first, at))) {
        let (above, row) = matrix.split_at_mut((6 * first + at) * blocks);
        for s in first..blocks {
            let mut sum = row[s];
            for above in above.chunks_exact(blocks) {
                add(&mut sum, -above[first][at], above[s]);
            }
            row[s] = sum;
        }
        let pivot = row[first][at];
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        let scale = 1.0 / pivot.sqrt();
        for part in &mut row[first..blocks] {
            *part = part.map(|value| value * scale);
        }
        row[first][at] = scale;
    }
    Some(())
}

/// Solves a factored system, in place.
pub(super) fn solve(factor: &[Six], vector: &mut [Six]) {
    unrolled!(vector.len(), solve_unrolled(factor.as_flattened(), vector.as_flattened_mut()));
}

#[inline(always)]
fn solve_unrolled(factor: &[f64], vector: &mut [f64], blocks: usize) {
    let n = 6 * blocks;
    let (factor, vector) = (&factor[..n * n], &mut vector[..n]);
    for k in 0..n {
        let mut value = vector[k];
        for i in 0..k {
            value -= vector[i] * factor[i * n + k];
        }
        vector[k] = value * factor[k * n + k];
    }
    for k in (0..n).rev() {
        let mut sum = 0.0;
        for i in k + 1..n {
            sum += factor[k * n + i] * vector[i];
        }
        vector[k] = (vector[k] - sum) * factor[k * n + k];
    }
}
