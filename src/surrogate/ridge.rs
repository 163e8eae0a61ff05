//! Ridge polynomials: the baseline that knows no physics.
//!
//! Terms and target are standardised, then fitted by `linfa-elasticnet` with an
//! L1 share of 0. The penalty is the one with the smallest leave-one-out error
//! among the designs given, so an outer leave-one-out stays honest.

use super::link::Link;
use super::{Estimate, Fitted, Measured, infills};
use crate::input::stiffness::Infill;
use linfa::prelude::{Dataset, Fit};
use linfa_elasticnet::ElasticNet;
use nalgebra::{DMatrix, DVector};
use ndarray::{Array1, Array2};

/// Penalties tried, in units of the standardised terms.
pub(super) const PENALTIES: [f64; 4] = [1e-6, 1e-4, 1e-3, 1e-2];

/// Sweeps of coordinate descent, always as many: linfa ends earlier by the duality gap, which
/// says nothing where there is no L1 share. The terms are little alike: with any two of the
/// shipped designs left out 130 sweeps leave less than 1e-10 of a coefficient.
const SWEEPS: u32 = 150;

/// A fitted polynomial in (density, direction) on the scale of its link.
#[derive(Debug)]
pub(super) struct Ridge {
    link: Link,
    degree: u8,
    terms: Vec<Standard>,
    target: Standard,
    coefficients: Vec<f64>,
    /// Residual standard deviation, in units of the standardised target.
    residual_sd: f64,
    /// Inverse of the Gram matrix of the terms, with the constant first.
    spread: DMatrix<f64>,
    penalty: f64,
}

/// Shift and scale that bring values to mean 0 and standard deviation 1.
#[derive(Debug, Clone, Copy)]
struct Standard {
    mean: f64,
    sd: f64,
}

impl Standard {
    fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
        Standard { mean, sd: if variance > 0.0 { variance.sqrt() } else { 1.0 } }
    }

    fn apply(self, value: f64) -> f64 {
        (value - self.mean) / self.sd
    }
}

/// The terms of a polynomial without its constant.
fn terms(infill: Infill, degree: u8) -> Vec<f64> {
    // About the middle of the printable range, so that terms are less alike.
    let (u, v) = (infill[0] / 20.0 - 1.0, infill[1] / 20.0 - 1.0);
    match degree {
        1 => vec![u, v],
        _ => vec![u, v, u * v, u * u, v * v],
    }
}

/// Fits with the best of `penalties`; `None` if nothing can be fitted.
pub(super) fn fit(measured: &Measured, degree: u8, link: Link, penalties: &[f64]) -> Option<Ridge> {
    if let [penalty] = penalties {
        return fit_one(measured, degree, link, *penalty);
    }
    let folds = measured.fold(measured.targets().len());
    let errors = |&penalty: &f64| {
        let error = |(others, one): &(Measured, Measured)| {
            let predicted = fit_one(others, degree, link, penalty)?.predict(infills(one).next()?);
            Some((predicted.mean / one.targets()[0] - 1.0).abs())
        };
        Some((penalty, folds.iter().map(error).sum::<Option<f64>>()?))
    };
    let best = penalties.iter().filter_map(errors).min_by(|a, b| a.1.total_cmp(&b.1));
    fit_one(measured, degree, link, best?.0)
}

fn fit_one(measured: &Measured, degree: u8, link: Link, penalty: f64) -> Option<Ridge> {
    let rows: Vec<Vec<f64>> = infills(measured).map(|infill| terms(infill, degree)).collect();
    let (n, count) = (rows.len(), rows.first()?.len());
    let scales: Vec<Standard> = (0..count)
        .map(|j| Standard::of(&rows.iter().map(|row| row[j]).collect::<Vec<_>>()))
        .collect();
    let raw: Vec<f64> = measured.targets().iter().map(|&k| link.forward(k)).collect();
    let target = Standard::of(&raw);
    let x = Array2::from_shape_fn((n, count), |(i, j)| scales[j].apply(rows[i][j]));
    let y: Array1<f64> = raw.iter().map(|&g| target.apply(g)).collect();
    let design = DMatrix::from_fn(n, count + 1, |i, j| if j == 0 { 1.0 } else { x[[i, j - 1]] });
    // None where the designs do not tell the terms apart.
    let spread = design.tr_mul(&design).cholesky()?.inverse();
    let net = ElasticNet::params()
        .l1_ratio(0.0)
        .penalty(penalty)
        .with_intercept(false)
        .tolerance(0.0)
        .max_iterations(SWEEPS)
        .fit(&Dataset::new(x.clone(), y.clone()))
        .ok()?;
    let residual = &y - &x.dot(net.hyperplane());
    let freedom = n.saturating_sub(count + 1).max(1) as f64;
    let residual_sd = (residual.dot(&residual) / freedom).sqrt();
    let coefficients = net.hyperplane().to_vec();
    Some(Ridge { link, degree, terms: scales, target, coefficients, residual_sd, spread, penalty })
}

impl Fitted for Ridge {
    fn predict(&self, infill: Infill) -> Estimate {
        let scaled: Vec<f64> = terms(infill, self.degree)
            .iter()
            .zip(&self.terms)
            .map(|(&term, standard)| standard.apply(term))
            .collect();
        let g: f64 = scaled.iter().zip(&self.coefficients).map(|(x, b)| x * b).sum();
        let row = DVector::from_iterator(
            scaled.len() + 1,
            std::iter::once(1.0).chain(scaled.iter().copied()),
        );
        let leverage = row.dot(&(&self.spread * &row));
        let (mean, slope) = self.link.backward(self.target.mean + self.target.sd * g);
        let link_sd = self.target.sd * self.residual_sd * (1.0 + leverage).sqrt();
        Estimate { mean, sd: (slope * link_sd).hypot(super::gp::READING_SD * mean) }
    }

    fn describe(&self) -> String {
        format!("polynomial of degree {}, ridge penalty {}", self.degree, self.penalty)
    }
}
