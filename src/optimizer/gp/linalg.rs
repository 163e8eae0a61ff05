//! Triangular linear algebra on packed rows: row `i` of a lower triangle holds `i + 1` numbers
//! at offset `i (i + 1) / 2`.

/// A Cholesky factor L, `A = L L^T`.
#[derive(Debug, Clone, Default)]
pub struct Cholesky {
    packed: Vec<f64>,
    n: usize,
}

/// Where row `i` starts.
pub fn offset(i: usize) -> usize {
    i * (i + 1) / 2
}

/// Row `i` of a packed lower triangle.
pub fn row(packed: &[f64], i: usize) -> &[f64] {
    &packed[offset(i)..offset(i) + i + 1]
}

/// Scalar product with four running sums, so that it runs in vector registers; the order of the
/// additions is fixed, hence the same result on every machine.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (chunks_a, chunks_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let tail: f64 = chunks_a.remainder().iter().zip(chunks_b.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in chunks_a.zip(chunks_b) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + tail
}

impl Cholesky {
    /// Factors the packed lower triangle of a symmetric matrix; `None` if it is not positive
    /// definite to working precision.
    pub fn new(packed: &[f64], n: usize) -> Option<Self> {
        let mut factor = Cholesky { packed: Vec::with_capacity(packed.len() + 8 * n), n: 0 };
        for i in 0..n {
            let a = row(packed, i);
            if !factor.append(&a[..i], a[i]) {
                return None;
            }
        }
        Some(factor)
    }

    /// Grows A by a row with off-diagonal `a` and diagonal `diagonal`; false, and no change, if
    /// the result is not positive definite.
    pub fn append(&mut self, a: &[f64], diagonal: f64) -> bool {
        let solved = self.forward(a);
        let pivot = diagonal - dot(&solved, &solved);
        if !(pivot > 1e-14 * diagonal && pivot.is_finite()) {
            return false;
        }
        self.packed.extend_from_slice(&solved);
        self.packed.push(pivot.sqrt());
        self.n += 1;
        true
    }

    /// Solves `L x = b` for the first `b.len()` unknowns.
    pub fn forward(&self, b: &[f64]) -> Vec<f64> {
        let mut x = Vec::with_capacity(b.len());
        for i in 0..b.len().min(self.n) {
            let l = row(&self.packed, i);
            x.push((b[i] - dot(&l[..i], &x)) / l[i]);
        }
        x
    }

    /// Unknown `x.len()` of `L x = b`, given those before it: for solutions that may end early.
    pub fn forward_step(&self, x: &[f64], b: f64) -> f64 {
        let l = row(&self.packed, x.len());
        (b - dot(&l[..x.len()], x)) / l[x.len()]
    }

    /// Solves `A x = b`.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x = self.forward(b);
        for i in (0..self.n).rev() {
            let l = row(&self.packed, i);
            x[i] /= l[i];
            let xi = x[i];
            x[..i].iter_mut().zip(l).for_each(|(x, l)| *x -= l * xi);
        }
        x
    }

    /// `log det A`.
    pub fn log_determinant(&self) -> f64 {
        (0..self.n).map(|i| 2.0 * libm::log(self.packed[offset(i) + i])).sum()
    }

    /// The packed lower triangle of the inverse of A.
    pub fn inverse(&self) -> Vec<f64> {
        let mut w = vec![0.0; self.packed.len()];
        for i in 0..self.n {
            let l = row(&self.packed, i);
            let (done, rest) = w.split_at_mut(offset(i));
            let wi = &mut rest[..=i];
            wi[i] = 1.0;
            for (k, &factor) in l[..i].iter().enumerate() {
                wi.iter_mut().zip(row(done, k)).for_each(|(a, b)| *a -= factor * b);
            }
            wi.iter_mut().for_each(|a| *a /= l[i]);
        }
        let mut inverse = vec![0.0; self.packed.len()];
        for k in 0..self.n {
            let wk = row(&w, k);
            for i in 0..=k {
                let factor = wk[i];
                let target = &mut inverse[offset(i)..offset(i) + i + 1];
                target.iter_mut().zip(wk).for_each(|(a, b)| *a += factor * b);
            }
        }
        inverse
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix() -> Vec<f64> {
        vec![4.0, 2.0, 5.0, 0.5, 1.0, 3.0, 0.1, 0.2, 0.3, 2.0, 0.7, 0.1, 0.9, 0.2, 6.0]
    }

    fn entry(packed: &[f64], i: usize, j: usize) -> f64 {
        row(packed, i.max(j))[i.min(j)]
    }

    #[test]
    fn solve_and_inverse_agree_with_the_matrix() {
        let (a, n) = (matrix(), 5);
        let factor = Cholesky::new(&a, n).unwrap();
        let inverse = factor.inverse();
        for i in 0..n {
            let mut unit = vec![0.0; n];
            unit[i] = 1.0;
            let x = factor.solve(&unit);
            for j in 0..n {
                assert!((x[j] - entry(&inverse, i, j)).abs() < 1e-14);
                let product: f64 = (0..n).map(|k| entry(&a, j, k) * x[k]).sum();
                assert!((product - unit[j]).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn the_determinant_is_that_of_the_leading_block() {
        let factor = Cholesky::new(&matrix(), 2).unwrap();
        assert!((factor.log_determinant() - 16f64.ln()).abs() < 1e-14);
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        assert!(Cholesky::new(&[1.0, 1.0, 1.0], 2).is_none());
        assert!(Cholesky::new(&[f64::NAN], 1).is_none());
        let mut factor = Cholesky::new(&[1.0], 1).unwrap();
        assert!(!factor.append(&[2.0], 1.0) && factor.n == 1);
    }
}
