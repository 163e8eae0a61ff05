//! The chosen model of each axis, and the choice.

use super::hull::Hull;
use super::loo::{Data, Loo};
use super::{Computed, Estimate, Fitted, ModelKind, Prediction};
use crate::stiffness::check_all;
use crate::stiffness::{Axis, Infill, Measurement, SurrogateError};
use finray::FingerError;
use finray::printed::PrintedFinger;

/// Fewest designs that a model is fitted to without computing any: the quadratic has six
/// terms, and a leave-one-out error needs one design more than that.
pub const ENOUGH: usize = 7;
/// Fewest designs for which leave-one-out may choose a process about the computed stiffness.
const SEVERAL: usize = 4;

/// Stiffness of a finger as a function of its infill, fitted to measurements.
#[derive(Debug)]
pub struct Model {
    /// The measurements it was fitted to.
    pub measurements: Vec<Measurement>,
    hull: Hull,
    /// By axis.
    chosen: [Chosen; 2],
    /// Leave-one-out errors: one row per axis and model, assembly first.
    pub loo: Vec<Loo>,
    /// The fingers as their ribs have them, each computed once.
    computed: Computed,
    /// Whether the models are of ratios to the computed stiffness, which takes some 0.2 s a finger.
    pub ratios: bool,
}

/// The model of one axis and the factor on its standard deviation.
#[derive(Debug)]
struct Chosen {
    fitted: Box<dyn Fitted>,
    widen: f64,
}

/// Fits every model, chooses one per axis by its leave-one-out error. Of [`ENOUGH`] designs
/// without the finger, which costs nothing; of fewer about its computed stiffness.
///
/// # Errors
/// A measurement that cannot be used, none at all, designs that differ in too few respects,
/// or of few measurements one of a finger that cannot be computed.
pub fn fit(measurements: &[Measurement], finger: &PrintedFinger) -> Result<Model, SurrogateError> {
    check_all(measurements)?;
    let infills: Vec<Infill> = measurements.iter().map(Measurement::infill).collect();
    let (ratios, kinds) = match measurements.len() {
        ENOUGH.. => (false, &ModelKind::MEASURED[..]),
        SEVERAL.. => (true, &[ModelKind::ComputedScale, ModelKind::ComputedProcess][..]),
        _ => (true, &[ModelKind::ComputedScale][..]),
    };
    let computed = Computed::new(finger);
    let choose = |axis| {
        let unit = |m: &Measurement| match ratios {
            true => computed.stiffness(axis, m.infill()),
            false => Ok(1.0),
        };
        let units = measurements.iter().map(unit).collect::<Result<_, FingerError>>()?;
        choose(axis, &Data::new(axis, measurements, units), kinds)
    };
    let (assembly, mut loo) = choose(Axis::Assembly)?;
    let (compliance, rest) = choose(Axis::Compliance)?;
    loo.extend(rest);
    let hull = Hull::new(&infills);
    let measurements = measurements.to_vec();
    Ok(Model { measurements, hull, chosen: [assembly, compliance], loo, computed, ratios })
}

fn choose(
    axis: Axis,
    data: &Data,
    kinds: &[ModelKind],
) -> Result<(Chosen, Vec<Loo>), SurrogateError> {
    let mut loo: Vec<Loo> = kinds.iter().map(|&kind| data.leave_one_out(kind)).collect();
    let unfittable = SurrogateError::Unfittable { axis: axis.label() };
    // A single finger leaves no error, and no choice.
    let eligible = |row: &&mut Loo| match row.model {
        ModelKind::Linear => false,
        ModelKind::ComputedScale => true,
        _ => row.standardised_rms.is_finite(),
    };
    let best = loo
        .iter_mut()
        .filter(eligible)
        .min_by(|a, b| a.mean_absolute_percent.total_cmp(&b.mean_absolute_percent))
        .ok_or(unfittable.clone())?;
    best.chosen = true;
    // Too sure of itself: widen until the left-out errors fit. Never narrow.
    let widen = best.standardised_rms.max(1.0);
    let fitted = data.fit(best.model).ok_or(unfittable)?;
    Ok((Chosen { fitted, widen }, loo))
}

impl Model {
    /// Stiffness of one finger, N/m, for any density (percent; below 1 counts
    /// as 1) and direction (degrees). The standard deviation is that of a
    /// finger yet to be printed: model error and scatter together.
    ///
    /// # Errors
    /// If the model rests on the computed stiffness and the finger cannot be computed.
    pub fn predict(
        &self,
        density_percent: f64,
        direction_deg: f64,
    ) -> Result<Prediction, FingerError> {
        let infill = [density_percent, direction_deg];
        let along = |axis| {
            let Chosen { fitted, widen } = &self.chosen[axis as usize];
            let unit = if self.ratios { self.computed.stiffness(axis, infill)? } else { 1.0 };
            let Estimate { mean, sd } = fitted.predict(infill);
            Ok::<_, FingerError>(Estimate { mean: mean * unit, sd: sd * widen * unit })
        };
        Ok(Prediction {
            compliance: along(Axis::Compliance)?,
            assembly: along(Axis::Assembly)?,
            hull_distance: self.hull.distance(infill),
        })
    }

    /// How many fingers it rests on, in words.
    pub fn counted(&self) -> String {
        match self.measurements.len() {
            1 => "1 measured design".to_owned(),
            count => format!("{count} measured designs"),
        }
    }

    /// The row of the model used on an axis.
    pub fn chosen(&self, axis: Axis) -> Option<&Loo> {
        self.loo.iter().find(|row| row.axis == axis && row.chosen)
    }

    /// The model's parameters on an axis, in words.
    pub fn describe(&self, axis: Axis) -> String {
        self.chosen[axis as usize].fitted.describe()
    }

    /// Factor by which the predicted standard deviation of an axis was widened
    /// so that the leave-one-out errors fit it; 1 if it fitted already.
    pub fn widening(&self, axis: Axis) -> f64 {
        self.chosen[axis as usize].widen
    }
}
