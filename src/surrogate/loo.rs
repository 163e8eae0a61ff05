//! Leave-one-out errors: how well a model predicts a finger it has not seen.

use super::kind::fit_axis;
use super::{Fitted, ModelKind};
use crate::input::stiffness::{Axis, Infill};
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
pub(super) fn leave_one_out(
    axis: Axis,
    kind: ModelKind,
    infills: &[Infill],
    stiffness: &[f64],
) -> Loo {
    let n = infills.len();
    // Collected by index: the thread count changes nothing.
    let pairs: Vec<Option<(f64, f64)>> = (0..n)
        .into_par_iter()
        .map(|out| {
            let keep = |i: &usize| *i != out;
            let x: Vec<Infill> = (0..n).filter(keep).map(|i| infills[i]).collect();
            let k: Vec<f64> = (0..n).filter(keep).map(|i| stiffness[i]).collect();
            let fitted: Box<dyn Fitted> = fit_axis(axis, kind, &x, &k)?;
            let estimate = fitted.predict(infills[out]);
            Some((estimate.mean, estimate.sd))
        })
        .collect();
    let pairs: Vec<(f64, f64)> =
        pairs.into_iter().map(|pair| pair.unwrap_or((f64::NAN, f64::NAN))).collect();
    let mean = |term: &dyn Fn(f64, f64, f64) -> f64| {
        pairs.iter().zip(stiffness).map(|(&(m, sd), &k)| term(m, sd, k)).sum::<f64>() / n as f64
    };
    Loo {
        axis,
        model: kind,
        rmse_n_per_mm: mean(&|m, _, k| (m - k).powi(2)).sqrt() / N_PER_MM,
        mean_absolute_percent: 100.0 * mean(&|m, _, k| (m / k - 1.0).abs()),
        standardised_rms: mean(&|m, sd, k| ((m - k) / sd).powi(2)).sqrt(),
        left_out: pairs.iter().map(|pair| pair.0).collect(),
        chosen: false,
    }
}
