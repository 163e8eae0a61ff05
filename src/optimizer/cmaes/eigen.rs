//! Eigen decomposition of a symmetric matrix by cyclic Jacobi rotations.
//!
//! Written out in plain arithmetic and square roots, so that it gives the same bits on every
//! platform; at the dimensions of a design space it takes microseconds.

/// Sweeps after which the decomposition is taken as it is (it converges in about ten).
const SWEEPS: usize = 60;

/// Eigenvalues and eigenvectors of the symmetric `n` x `n` row-major matrix `a`: column `j` of
/// the returned row-major matrix belongs to eigenvalue `j`. In no particular order.
pub fn symmetric_eigen(a: &[f64], n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut a = a.to_vec();
    let mut vectors = vec![0.0; n * n];
    for i in 0..n {
        vectors[i * n + i] = 1.0;
    }
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                rotated |= rotate(&mut a, &mut vectors, n, (p, q));
            }
        }
        if !rotated {
            break;
        }
    }
    ((0..n).map(|i| a[i * n + i]).collect(), vectors)
}

/// Annihilates `a[p][q]`; false if it is already negligible beside its diagonal.
fn rotate(a: &mut [f64], vectors: &mut [f64], n: usize, (p, q): (usize, usize)) -> bool {
    let (app, aqq, apq) = (a[p * n + p], a[q * n + q], a[p * n + q]);
    if apq.abs() <= 1e-17 * (app.abs() * aqq.abs()).sqrt() || !apq.is_finite() || apq == 0.0 {
        return false;
    }
    let theta = (aqq - app) / (2.0 * apq);
    let t = theta.signum() / (theta.abs() + (1.0 + theta * theta).sqrt());
    let c = 1.0 / (1.0 + t * t).sqrt();
    let s = t * c;
    for k in 0..n {
        let (akp, akq) = (a[k * n + p], a[k * n + q]);
        a[k * n + p] = c * akp - s * akq;
        a[k * n + q] = s * akp + c * akq;
    }
    for k in 0..n {
        let (apk, aqk) = (a[p * n + k], a[q * n + k]);
        a[p * n + k] = c * apk - s * aqk;
        a[q * n + k] = s * apk + c * aqk;
    }
    a[p * n + q] = 0.0;
    a[q * n + p] = 0.0;
    for k in 0..n {
        let (vkp, vkq) = (vectors[k * n + p], vectors[k * n + q]);
        vectors[k * n + p] = c * vkp - s * vkq;
        vectors[k * n + q] = s * vkp + c * vkq;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_is_put_together_again_from_its_parts() {
        let n = 6;
        // The Hilbert matrix: symmetric, positive definite and badly conditioned.
        let a: Vec<f64> = (0..n * n).map(|k| 1.0 / (k / n + k % n + 1) as f64).collect();
        let (values, v) = symmetric_eigen(&a, n);
        for i in 0..n {
            for j in 0..n {
                let (mut again, mut unit) = (0.0, 0.0);
                for k in 0..n {
                    again += v[i * n + k] * values[k] * v[j * n + k];
                    unit += v[k * n + i] * v[k * n + j];
                }
                assert!((again - a[i * n + j]).abs() < 1e-14);
                assert!((unit - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((least / 1.082_799_484_565_55e-7 - 1.0).abs() < 1e-6, "{least}");
    }

    #[test]
    fn nothing_finite_is_needed_to_end() {
        let (values, _) = symmetric_eigen(&[f64::NAN, f64::INFINITY, f64::INFINITY, 1.0], 2);
        assert_eq!(values.len(), 2);
    }
}
