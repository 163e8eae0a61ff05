//! Leave-one-out errors: how well a model predicts a finger it has not seen.

use super::kind::fit_axis;
use super::{Fitted, Measured, ModelKind, left_out, measured};
use crate::stiffness::{Axis, Measurement};
use input::units::N_PER_MM;

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
    /// Root mean square of error / predicted standard deviation: above 1 the model is too sure.
    pub standardised_rms: f64,
    /// Prediction for each design when it is left out, N/m, in input order.
    pub left_out: Vec<f64>,
    /// Whether the program uses this model on this axis.
    pub chosen: bool,
}

pub(super) struct Data {
    axis: Axis,
    /// Stiffness, N/m; of computed kinds measured / computed.
    measured: Measured,
    /// Unit of each design's value, N/m.
    units: Vec<f64>,
}

impl Data {
    /// Of these measurements, in units of each.
    pub fn new(axis: Axis, measurements: &[Measurement], units: Vec<f64>) -> Self {
        let infills: Vec<_> = measurements.iter().map(Measurement::infill).collect();
        let values = measurements.iter().zip(&units).map(|(m, unit)| m.stiffness(axis) / unit);
        Data { axis, measured: measured(&infills, &values.collect::<Vec<_>>()), units }
    }

    /// A model of all designs.
    pub fn fit(&self, kind: ModelKind) -> Option<Box<dyn Fitted>> {
        fit_axis(self.axis, kind, &self.measured)
    }

    /// Fits `kind` without each design in turn and predicts that design.
    pub fn leave_one_out(&self, kind: ModelKind) -> Loo {
        let count = self.measured.targets().len();
        let predicted = left_out(&self.measured, |others, infill| {
            Some(fit_axis(self.axis, kind, others)?.predict(infill))
        });
        let mean = |term: &dyn Fn(f64, f64, f64) -> f64| {
            let terms = predicted.iter().zip(self.measured.targets()).zip(&self.units);
            let terms = terms.map(|((e, &k), unit)| term(e.mean * unit, e.sd * unit, k * unit));
            terms.sum::<f64>() / count as f64
        };
        Loo {
            axis: self.axis,
            model: kind,
            rmse_n_per_mm: mean(&|m, _, k| (m - k).powi(2)).sqrt() / N_PER_MM,
            mean_absolute_percent: 100.0 * mean(&|m, _, k| (m / k - 1.0).abs()),
            standardised_rms: mean(&|m, sd, k| ((m - k) / sd).powi(2)).sqrt(),
            left_out: predicted.iter().zip(&self.units).map(|(e, unit)| e.mean * unit).collect(),
            chosen: false,
        }
    }
}
