//! Ridge polynomials: baseline without physics.
//!
//! Terms and target are standardised, then fitted by `linfa-elasticnet` with an L1 share of 0. The
//! penalty is the one with the smallest leave-one-out error over the given designs.
//!
//! The terms are first rotated onto their principal axes. A rotation does not change the ridge
//! penalty, and along axes that are orthogonal one sweep of coordinate descent is exact.

use super::link::Link;
use super::{Estimate, Fitted, Samples, Standardizer, infills, leave_one_out};
use crate::stiffness::Infill;
use linfa::prelude::{Dataset, Fit};
use linfa_elasticnet::ElasticNet;
use nalgebra::{DMatrix, DVector};
use ndarray::{Array1, Array2};

/// Candidate ridge penalties.
pub(super) const PENALTIES: [f64; 4] = [1e-6, 1e-4, 1e-3, 1e-2];

/// A fitted polynomial in (density, direction) on the scale of its link.
#[derive(Debug)]
pub(super) struct Ridge {
    link: Link,
    degree: u8,
    terms: Vec<Standardizer>,
    target: Standardizer,
    coefficients: Vec<f64>,
    /// Residual standard deviation, in units of the standardised target.
    residual_sd: f64,
    /// Inverse of the Gram matrix of the terms, with the constant first.
    inverse_gram: DMatrix<f64>,
    penalty: f64,
}

fn terms(infill: Infill, degree: u8) -> Vec<f64> {
    // Centred on the printable range, so that the terms are less correlated.
    let (u, v) = (infill[0] / 20.0 - 1.0, infill[1] / 20.0 - 1.0);
    if degree == 1 { vec![u, v] } else { vec![u, v, u * v, u * u, v * v] }
}

/// Fits the polynomial with the penalty of the smallest leave-one-out error; `None` if no fit is possible.
pub(super) fn fit(measured: &Samples, degree: u8, link: Link, penalties: &[f64]) -> Option<Ridge> {
    if let [penalty] = penalties {
        return fit_with_penalty(measured, degree, link, *penalty);
    }
    let error = |&penalty: &f64| {
        let predicted = leave_one_out(measured, |others, infill| {
            Some(fit_with_penalty(others, degree, link, penalty)?.predict(infill))
        });
        let off = predicted.iter().zip(measured.targets()).map(|(e, k)| (e.mean / k - 1.0).abs());
        (penalty, off.sum::<f64>())
    };
    let fitted = penalties.iter().map(error).filter(|(_, error)| !error.is_nan());
    let best = fitted.min_by(|a, b| a.1.total_cmp(&b.1));
    fit_with_penalty(measured, degree, link, best?.0)
}

fn fit_with_penalty(measured: &Samples, degree: u8, link: Link, penalty: f64) -> Option<Ridge> {
    let rows: Vec<Vec<f64>> = infills(measured).map(|infill| terms(infill, degree)).collect();
    let (n, count) = (rows.len(), rows.first()?.len());
    let of_column = |j: usize| Standardizer::of(rows.iter().map(move |row| row[j]), 0);
    let terms: Vec<Standardizer> = (0..count).map(of_column).collect();
    let raw: Vec<f64> = measured.targets().iter().map(|&k| link.forward(k)).collect();
    let target = Standardizer::of(raw.iter().copied(), 0);
    let x = DMatrix::from_fn(n, count, |i, j| terms[j].apply(rows[i][j]));
    let y: Array1<f64> = raw.iter().map(|&g| target.apply(g)).collect();
    let design = x.clone().insert_column(0, 1.0);
    // `None` if the designs do not distinguish the terms.
    let inverse_gram = design.tr_mul(&design).cholesky()?.inverse();
    let axes = x.tr_mul(&x).symmetric_eigen().eigenvectors;
    let rotated = &x * &axes;
    let rotated = Array2::from_shape_fn((n, count), |place| rotated[place]);
    let net = ElasticNet::params()
        .l1_ratio(0.0)
        .penalty(penalty)
        .with_intercept(false)
        .max_iterations(1)
        .fit(&Dataset::new(rotated.clone(), y.clone()))
        .ok()?;
    let residual = &y - &rotated.dot(net.hyperplane());
    let degrees_of_freedom = n.saturating_sub(count + 1).max(1) as f64;
    let residual_sd = (residual.dot(&residual) / degrees_of_freedom).sqrt();
    let along_axes = DVector::from_iterator(count, net.hyperplane().iter().copied());
    let coefficients = (axes * along_axes).data.into();
    Some(Ridge { link, degree, terms, target, coefficients, residual_sd, inverse_gram, penalty })
}

impl Fitted for Ridge {
    fn predict(&self, infill: Infill) -> Estimate {
        let terms = terms(infill, self.degree).into_iter().zip(&self.terms);
        let scaled: Vec<f64> = terms.map(|(term, standard)| standard.apply(term)).collect();
        let g: f64 = scaled.iter().zip(&self.coefficients).map(|(x, b)| x * b).sum();
        let row = DVector::from_vec(scaled).insert_row(0, 1.0);
        let leverage = row.dot(&(&self.inverse_gram * &row));
        let (mean, slope) = self.link.backward(self.target.mean + self.target.sd * g);
        let link_sd = self.target.sd * self.residual_sd * (1.0 + leverage).sqrt();
        Estimate { mean, sd: libm::hypot(slope * link_sd, super::gp::READING_SD * mean) }
    }

    fn describe(&self) -> String {
        format!("polynomial of degree {}, ridge penalty {}", self.degree, self.penalty)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stiffness::parse;
    use input::shipped::STIFFNESS;

    /// At the minimum, the gradients of the squared error and of the penalty cancel.
    #[test]
    fn one_sweep_along_the_principal_axes_is_the_minimum() {
        let shipped = parse(STIFFNESS[0].text, STIFFNESS[0].file).unwrap();
        let infills: Vec<Infill> = shipped.iter().map(|m| m.infill()).collect();
        let stiffness: Vec<f64> = shipped.iter().map(|m| m.compliance).collect();
        let n = stiffness.len() as f64;
        let data = crate::surrogate::samples(&infills, &stiffness);
        for penalty in PENALTIES {
            let fitted = fit_with_penalty(&data, 2, Link::IDENTITY, penalty).unwrap();
            let row = |&infill: &Infill| -> Vec<f64> {
                let terms = terms(infill, 2);
                terms.iter().zip(&fitted.terms).map(|(&t, scale)| scale.apply(t)).collect()
            };
            let rows: Vec<Vec<f64>> = infills.iter().map(row).collect();
            for (j, coefficient) in fitted.coefficients.iter().enumerate() {
                let products = rows.iter().zip(&stiffness).map(|(row, &k)| {
                    let g: f64 = row.iter().zip(&fitted.coefficients).map(|(x, b)| x * b).sum();
                    row[j] * (fitted.target.apply(k) - g)
                });
                let gradient = products.sum::<f64>() - n * penalty * coefficient;
                assert!(gradient.abs() < 1e-12 * n, "{penalty}, term {j}: {gradient}");
            }
        }
    }
}
