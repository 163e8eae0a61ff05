use super::*;

const X: [f64; 7] = [0.0, 0.4, 1.1, 1.5, 2.3, 2.9, 3.6];
const AT: f64 = 1.9;

fn kernel(a: f64, b: f64) -> f64 {
    0.7 * matern52(((a - b) / 0.8).powi(2))
}

/// Covariance of the values, with noise and a normal prior of this variance of both terms.
fn covariance(prior: f64) -> DMatrix<f64> {
    let noise = |i, j| if i == j { 0.01 } else { 0.0 };
    DMatrix::from_fn(7, 7, |i, j| kernel(X[i], X[j]) + noise(i, j) + prior * (1.0 + X[i] * X[j]))
}

fn towards(prior: f64) -> DVector<f64> {
    DVector::from_iterator(7, X.iter().map(|&x| kernel(x, AT) + prior * (1.0 + x * AT)))
}

fn values() -> [f64; 7] {
    X.map(|x| 3.0 - 2.0 * x + libm::sin(2.0 * x))
}

#[test]
fn a_flat_prior_is_the_limit_of_a_wide_one() {
    let flat = Process::new(covariance(0.0), &X.map(|x| [1.0, x]), &values()).unwrap();
    let wide = Process::new(covariance(1e6), &[[]; 7], &values()).unwrap();
    let (k, h, prior) = (towards(1e6), [1.0, AT], 0.7 + 1e6 * (1.0 + AT * AT));
    let (mean, variance) = (wide.mean(&k, &[]), wide.variance(&k, &[], prior));
    assert!((flat.mean(&towards(0.0), &h) - mean).abs() < 1e-5);
    assert!((flat.variance(&towards(0.0), &h, 0.7) - variance).abs() < 1e-5);
    // (2.43) and (2.45): but for log |B| the wide likelihood becomes the flat one.
    let difference = wide.log_likelihood() + 0.5 * libm::log(1e6 * 1e6);
    assert!((flat.log_likelihood() - difference).abs() < 1e-4);
}

#[test]
fn the_profile_is_the_largest_likelihood_over_scale_and_coefficients() {
    let (n, y) = (7.0, DVector::from_row_slice(&values()));
    let process = Process::new(covariance(0.0), &X.map(|x| [1.0, x]), &values()).unwrap();
    let inverse = covariance(0.0).try_inverse().unwrap();
    let log_determinant = libm::log(covariance(0.0).determinant());
    let likelihood = |a: f64, b: f64, scale: f64| {
        let rest = DVector::from_fn(7, |i, _| y[i] - a - b * X[i]);
        let quadratic = rest.dot(&(&inverse * &rest)) / scale;
        -0.5 * (quadratic + n * libm::log(scale) + log_determinant - n)
    };
    let ([a, b], scale) = (process.coefficients, process.scale() * 5.0 / n);
    let most = process.profile_log_likelihood();
    assert!((likelihood(a, b, scale) - most).abs() < 1e-9);
    for step in [-0.01, 0.01] {
        assert!(likelihood(a + step, b, scale) < most);
        assert!(likelihood(a, b + step, scale) < most);
        assert!(likelihood(a, b, scale * (1.0 + step)) < most);
    }
}

#[test]
fn what_cannot_be_conditioned_on_is_refused() {
    let alike = X.map(|_| [1.0, 3.0]);
    assert!(Process::new(covariance(0.0), &alike, &values()).is_none());
    assert!(Process::new(covariance(0.0), &alike[..6], &values()).is_none());
    assert!(Process::new(covariance(0.0), &X.map(|x| [x]), &[f64::NAN; 7]).is_none());
    assert!(Process::new(-covariance(0.0), &X.map(|x| [x]), &values()).is_none());
    assert!(Process::<1>::new(DMatrix::zeros(0, 0), &[], &[]).is_some_and(|p| p.len() == 0));
}
