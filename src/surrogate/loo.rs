//! Leave-one-out errors: how well a model predicts a finger it has not seen.

use super::kind::fit_axis;
use super::{Estimate, Fitted, Measured, ModelKind, infills};
use crate::input::stiffness::Axis;
use crate::units::N_PER_MM;
use rayon::prelude::*;

/// Leave-one-out error of one model on one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Loo {
    /// The axis.
    pub axis: Axis,
    /// The model.
    pub model: ModelKind,
    /// Root mean square error, N/mm; NaN if the model could not be fitted.
    pub rmse_n_per_mm: f64,
    /// Mean absolute error relative to the measured stiffness, percent.
    pub mean_absolute_percent: f64,
    /// Root mean square of error / predicted standard deviation: 1 if the
    /// uncertainty is right, above 1 if the model is too sure of itself.
    pub standardised_rms: f64,
    /// Prediction for each design when it is left out, N/m, in input order.
    pub left_out: Vec<f64>,
    /// Whether the program uses this model on this axis.
    pub chosen: bool,
}

/// Fits `kind` without each design in turn and predicts that design.
pub(super) fn leave_one_out(axis: Axis, kind: ModelKind, measured: &Measured) -> Loo {
    // Collected by index: the thread count changes nothing.
    let predicted: Vec<Estimate> = measured
        .fold(measured.targets().len())
        .into_par_iter()
        .map(|(others, one)| {
            let fitted = fit_axis(axis, kind, &others);
            let predict = |fitted: Box<dyn Fitted>| infills(&one).next().map(|x| fitted.predict(x));
            fitted.and_then(predict).unwrap_or(Estimate { mean: f64::NAN, sd: f64::NAN })
        })
        .collect();
    let mean = |term: &dyn Fn(f64, f64, f64) -> f64| {
        let terms = predicted.iter().zip(measured.targets()).map(|(e, &k)| term(e.mean, e.sd, k));
        terms.sum::<f64>() / predicted.len() as f64
    };
    Loo {
        axis,
        model: kind,
        rmse_n_per_mm: mean(&|m, _, k| (m - k).powi(2)).sqrt() / N_PER_MM,
        mean_absolute_percent: 100.0 * mean(&|m, _, k| (m / k - 1.0).abs()),
        standardised_rms: mean(&|m, sd, k| ((m - k) / sd).powi(2)).sqrt(),
        left_out: predicted.iter().map(|estimate| estimate.mean).collect(),
        chosen: false,
    }
}
