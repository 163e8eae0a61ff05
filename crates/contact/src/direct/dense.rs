//! Small dense symmetric systems, row by row, in sixes. Every inner loop runs along a row without
//! carrying a sum, so that no addition waits for the last, and over six at a time, unrolled.

/// Six neighbours in a row of a matrix, or the velocity or impulse of a body.
pub(super) type Six = [f64; 6];

/// Calls a function of a matrix that is compiled for the usual numbers of sixes to a row.
macro_rules! unrolled {
    ($sixes:expr, $function:ident($($argument:expr),*)) => {
        match $sixes {
            1 => $function($($argument,)* 1),
            2 => $function($($argument,)* 2),
            3 => $function($($argument,)* 3),
            4 => $function($($argument,)* 4),
            sixes => $function($($argument,)* sixes),
        }
    };
}

/// `to += factor * from`.
#[inline(always)]
fn add(to: &mut Six, factor: f64, from: Six) {
    for c in 0..6 {
        to[c] += factor * from[c];
    }
}

/// `result = matrix * vector` for a symmetric matrix with both halves.
pub(super) fn multiply(matrix: &[Six], vector: &[Six], result: &mut [Six]) {
    unrolled!(vector.len(), product(matrix, vector, result));
}

#[inline(always)]
fn product(matrix: &[Six], vector: &[Six], result: &mut [Six], sixes: usize) {
    let result = &mut result[..sixes];
    result.fill([0.0; 6]);
    // The rows serve as columns.
    for (k, &factor) in vector[..sixes].as_flattened().iter().enumerate() {
        let row = &matrix[k * sixes..][..sixes];
        for s in 0..sixes {
            add(&mut result[s], factor, row[s]);
        }
    }
}

/// Computes the Cholesky factorisation `U^T U` of a matrix with so many sixes to a row, in place of the upper
/// half, the diagonal holding the reciprocals of `U`'s; None if the matrix is not positive
/// definite (or not finite). What is left in the lower half means nothing.
pub(super) fn factor(matrix: &mut [Six], sixes: usize) -> Option<()> {
    unrolled!(sixes, factored(matrix))
}

#[inline(always)]
fn factored(matrix: &mut [Six], sixes: usize) -> Option<()> {
    for (first, at) in (0..sixes).flat_map(|first| (0..6).map(move |at| (first, at))) {
        let (above, row) = matrix.split_at_mut((6 * first + at) * sixes);
        for s in first..sixes {
            let mut sum = row[s];
            for above in above.chunks_exact(sixes) {
                add(&mut sum, -above[first][at], above[s]);
            }
            row[s] = sum;
        }
        let pivot = row[first][at];
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        let scale = 1.0 / pivot.sqrt();
        for part in &mut row[first..sixes] {
            *part = part.map(|value| value * scale);
        }
        row[first][at] = scale;
    }
    Some(())
}

/// Solves with the factor, in place.
pub(super) fn solve(factor: &[Six], vector: &mut [Six]) {
    unrolled!(vector.len(), solved(factor.as_flattened(), vector.as_flattened_mut()));
}

#[inline(always)]
fn solved(factor: &[f64], vector: &mut [f64], sixes: usize) {
    let n = 6 * sixes;
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
