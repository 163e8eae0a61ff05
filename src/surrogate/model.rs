//! The chosen model of each axis, and the choice.

use super::hull::Hull;
use super::kind::fit_axis;
use super::loo::{Loo, leave_one_out};
use super::{Estimate, Fitted, ModelKind, Prediction, measured};
use crate::input::stiffness::check_all;
use crate::input::stiffness::{Axis, Infill, Measurement, SurrogateError};

/// Stiffness of a finger as a function of its infill, fitted to measurements.
#[derive(Debug)]
pub struct Model {
    measurements: Vec<Measurement>,
    hull: Hull,
    assembly: Chosen,
    compliance: Chosen,
    loo: Vec<Loo>,
}

/// The model of one axis and the factor on its standard deviation.
#[derive(Debug)]
struct Chosen {
    fitted: Box<dyn Fitted>,
    widen: f64,
}

impl Chosen {
    fn predict(&self, infill: Infill) -> Estimate {
        let Estimate { mean, sd } = self.fitted.predict(infill);
        Estimate { mean, sd: sd * self.widen }
    }
}

/// Fits every model, chooses one per axis by its leave-one-out error.
///
/// # Errors
/// A measurement that cannot be used, fewer than [`MINIMUM`](crate::input::stiffness::MINIMUM) of them, or
/// designs that differ in too few respects.
pub fn fit(measurements: &[Measurement]) -> Result<Model, SurrogateError> {
    check_all(measurements)?;
    let infills: Vec<Infill> = measurements.iter().map(Measurement::infill).collect();
    let (assembly, mut loo) = choose(Axis::Assembly, measurements, &infills)?;
    let (compliance, rest) = choose(Axis::Compliance, measurements, &infills)?;
    loo.extend(rest);
    Ok(Model {
        measurements: measurements.to_vec(),
        hull: Hull::new(&infills),
        assembly,
        compliance,
        loo,
    })
}

fn choose(
    axis: Axis,
    measurements: &[Measurement],
    infills: &[Infill],
) -> Result<(Chosen, Vec<Loo>), SurrogateError> {
    let stiffness: Vec<f64> = measurements.iter().map(|m| m.stiffness(axis)).collect();
    let data = measured(infills, &stiffness);
    let mut loo: Vec<Loo> =
        ModelKind::ALL.into_iter().map(|kind| leave_one_out(axis, kind, &data)).collect();
    let unfittable = SurrogateError::Unfittable { axis: axis.label() };
    let best = loo
        .iter_mut()
        .filter(|row| row.model != ModelKind::Linear && row.standardised_rms.is_finite())
        .min_by(|a, b| a.mean_absolute_percent.total_cmp(&b.mean_absolute_percent))
        .ok_or(unfittable.clone())?;
    best.chosen = true;
    // Too sure of itself: widen until the left-out errors fit. Never narrow.
    let widen = best.standardised_rms.max(1.0);
    let fitted = fit_axis(axis, best.model, &data).ok_or(unfittable)?;
    Ok((Chosen { fitted, widen }, loo))
}

impl Model {
    /// Stiffness of one finger, N/m, for any density (percent; below 1 counts
    /// as 1) and direction (degrees). The standard deviation is that of a
    /// finger yet to be printed: model error and scatter together.
    pub fn predict(&self, density_percent: f64, direction_deg: f64) -> Prediction {
        let infill = [density_percent, direction_deg];
        Prediction {
            compliance: self.compliance.predict(infill),
            assembly: self.assembly.predict(infill),
            hull_distance: self.hull.distance(infill),
        }
    }

    /// Leave-one-out errors: one row per axis and model, assembly first.
    pub fn loo(&self) -> &[Loo] {
        &self.loo
    }

    /// The row of the model used on an axis.
    pub fn chosen(&self, axis: Axis) -> Option<&Loo> {
        self.loo.iter().find(|row| row.axis == axis && row.chosen)
    }

    /// The model's parameters on an axis, in words.
    pub fn describe(&self, axis: Axis) -> String {
        self.of(axis).fitted.describe()
    }

    /// Factor by which the predicted standard deviation of an axis was widened
    /// so that the leave-one-out errors fit it; 1 if it fitted already.
    pub fn widening(&self, axis: Axis) -> f64 {
        self.of(axis).widen
    }

    /// The measurements it was fitted to.
    pub fn measurements(&self) -> &[Measurement] {
        &self.measurements
    }

    fn of(&self, axis: Axis) -> &Chosen {
        match axis {
            Axis::Assembly => &self.assembly,
            Axis::Compliance => &self.compliance,
        }
    }
}
