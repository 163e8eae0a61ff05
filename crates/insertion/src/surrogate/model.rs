//! Candidate models of each axis, their leave-one-out errors, and the choice between them.

use super::hull::Hull;
use super::link::{Link, LinkKind};
use super::{Estimate, Fitted, Prediction, Samples, computed, gp, leave_one_out, ridge, samples};
use crate::Measurement;
use crate::stiffness::{Axis, Infill, SurrogateError};
use finray::printed::PrintedFinger;
use input::InputError;
use input::units::N_PER_MM;

/// Kind of model of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ModelKind {
    /// `k = a + b density + c direction` by least squares: the reference. Never chosen, since it becomes
    /// negative outside the data.
    Linear,
    /// The same terms with a ridge penalty, through a link that stays positive.
    RidgeLinear,
    /// All terms up to second degree with a ridge penalty, through the same link.
    RidgeQuadratic,
    /// A Gaussian process with a physical mean function.
    GaussianProcess,
    /// The computed stiffness times a constant factor.
    ComputedScale,
    /// A Gaussian process with a constant mean for the logarithm of measured / computed stiffness.
    ComputedProcess,
}

impl ModelKind {
    /// Models without computed stiffness, simplest first.
    pub const MEASURED: [ModelKind; 4] = [
        ModelKind::Linear,
        ModelKind::RidgeLinear,
        ModelKind::RidgeQuadratic,
        ModelKind::GaussianProcess,
    ];

    /// Returns a short name for tables.
    pub fn label(self) -> &'static str {
        match self {
            ModelKind::Linear => "linear (reference)",
            ModelKind::RidgeLinear => "ridge, degree 1",
            ModelKind::RidgeQuadratic => "ridge, degree 2",
            ModelKind::GaussianProcess => "Gaussian process, physical mean",
            ModelKind::ComputedScale => "computed, scaled",
            ModelKind::ComputedProcess => "Gaussian process, computed mean",
        }
    }
}

/// Fits a model of one axis to `measured`: stiffness, N/m, or, for the computed kinds, ratios of measured to computed
/// stiffness. Returns `None` if the fit fails.
fn fit_axis(axis: Axis, kind: ModelKind, measured: &Samples) -> Option<Box<dyn Fitted>> {
    let positive = Link::new(LinkKind::Identity, measured.targets());
    let fitted: Box<dyn Fitted> = match kind {
        ModelKind::Linear => Box::new(ridge::fit(measured, 1, Link::IDENTITY, &[0.0])?),
        ModelKind::RidgeLinear => Box::new(ridge::fit(measured, 1, positive, &ridge::PENALTIES)?),
        ModelKind::RidgeQuadratic => {
            Box::new(ridge::fit(measured, 2, positive, &ridge::PENALTIES)?)
        }
        ModelKind::GaussianProcess => Box::new(gp::fit(axis, measured)?),
        ModelKind::ComputedScale => Box::new(computed::fit(axis, measured)?),
        ModelKind::ComputedProcess => Box::new(gp::fit_ratio(measured)?),
    };
    Some(fitted)
}

/// Leave-one-out error of one model on one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Loo {
    /// Axis of the stiffness.
    pub axis: Axis,
    /// Kind of the model.
    pub model: ModelKind,
    /// Root mean square error, N/mm; NaN if the model could not be fitted.
    pub rmse_n_per_mm: f64,
    /// Mean absolute error relative to the measured stiffness, percent.
    pub mean_absolute_percent: f64,
    /// Root mean square of error / predicted standard deviation: above 1 the model is overconfident.
    pub standardised_rms: f64,
    /// Prediction for each design when it is left out, N/m, in input order.
    pub left_out: Vec<f64>,
    /// Whether the program uses this model on this axis.
    pub chosen: bool,
}

/// Measurements along one axis.
struct AxisData {
    axis: Axis,
    /// Stiffness, N/m, or ratios of measured to computed stiffness.
    measured: Samples,
    /// Factor from each value of `measured` to the stiffness, N/m: the computed stiffness for a ratio, else 1.
    units: Vec<f64>,
}

impl AxisData {
    /// Returns the data of an axis: each measured stiffness, N/m, divided by its unit.
    fn new(axis: Axis, measurements: &[Measurement], units: Vec<f64>) -> Self {
        let infills: Vec<_> = measurements.iter().map(Measurement::infill).collect();
        let values = measurements.iter().zip(&units).map(|(m, unit)| m.stiffness(axis) / unit);
        AxisData { axis, measured: samples(&infills, &values.collect::<Vec<_>>()), units }
    }

    /// Fits `kind` without each design in turn and predicts that design.
    fn leave_one_out(&self, kind: ModelKind) -> Loo {
        let count = self.measured.targets().len();
        let predicted = leave_one_out(&self.measured, |others, infill| {
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

/// Smallest number of designs to which models without computed stiffness are fitted: the quadratic has six
/// terms, and a leave-one-out error needs one more design.
pub const MIN_MEASURED: usize = 7;
/// Smallest number of designs for which [`ModelKind::ComputedProcess`] is a candidate.
const MIN_FOR_PROCESS: usize = 4;

/// Stiffness of a finger as a function of its infill, fitted to measurements.
#[derive(Debug)]
pub struct Model {
    /// The measurements it was fitted to.
    pub measurements: Vec<Measurement>,
    hull: Hull,
    chosen: [Chosen; 2],
    /// Leave-one-out errors of each axis and model, assembly first.
    pub loo: Vec<Loo>,
    /// Cache of the stiffness computed from the ribs.
    computed: computed::ComputedStiffness,
    /// Whether the models predict ratios to the computed stiffness, which takes about 0.2 s per finger.
    pub ratios: bool,
}

/// Chosen model of one axis and the factor on its standard deviation.
#[derive(Debug)]
struct Chosen {
    fitted: Box<dyn Fitted>,
    widen: f64,
}

/// Fits every candidate model to checked measurements ([`crate::stiffness::parse`]) and chooses one per axis by its
/// leave-one-out error. With fewer than [`MIN_MEASURED`] designs the models are based on the computed stiffness of
/// `finger`, which is not needed otherwise.
///
/// # Errors
/// If there is no measurement, the designs are too similar, or a computed stiffness is needed and cannot be computed.
pub fn fit(measurements: &[Measurement], finger: &PrintedFinger) -> Result<Model, SurrogateError> {
    let (ratios, kinds) = match measurements.len() {
        MIN_MEASURED.. => (false, &ModelKind::MEASURED[..]),
        MIN_FOR_PROCESS.. => (true, &[ModelKind::ComputedScale, ModelKind::ComputedProcess][..]),
        _ => (true, &[ModelKind::ComputedScale][..]),
    };
    let computed = computed::ComputedStiffness::new(finger);
    let choose = |axis| {
        let unit = |m: &Measurement| {
            if ratios { computed.stiffness(axis, m.infill()) } else { Ok(1.0) }
        };
        let units = measurements.iter().map(unit).collect::<Result<_, InputError>>()?;
        choose(&AxisData::new(axis, measurements, units), kinds)
    };
    let (assembly, mut loo) = choose(Axis::Assembly)?;
    let (compliance, rest) = choose(Axis::Compliance)?;
    loo.extend(rest);
    let hull = Hull::new(&measurements.iter().map(Measurement::infill).collect::<Vec<_>>());
    let measurements = measurements.to_vec();
    Ok(Model { measurements, hull, chosen: [assembly, compliance], loo, computed, ratios })
}

/// Chooses the model with the smallest leave-one-out error.
fn choose(data: &AxisData, kinds: &[ModelKind]) -> Result<(Chosen, Vec<Loo>), SurrogateError> {
    let mut loo: Vec<Loo> = kinds.iter().map(|&kind| data.leave_one_out(kind)).collect();
    let unfittable = SurrogateError::Unfittable(data.axis.label());
    // A single finger has no leave-one-out error.
    let eligible = |row: &&mut Loo| match row.model {
        ModelKind::Linear => false,
        ModelKind::ComputedScale => true,
        _ => row.standardised_rms.is_finite(),
    };
    let eligible = loo.iter_mut().filter(eligible);
    let best = eligible.min_by(|a, b| a.mean_absolute_percent.total_cmp(&b.mean_absolute_percent));
    let best = best.ok_or(unfittable.clone())?;
    best.chosen = true;
    // The standard deviation of an overconfident model is widened to the leave-one-out errors; none is narrowed.
    let widen = best.standardised_rms.max(1.0);
    let fitted = fit_axis(data.axis, best.model, &data.measured).ok_or(unfittable)?;
    Ok((Chosen { fitted, widen }, loo))
}

impl Model {
    /// Returns the stiffness of one finger, N/m, for any infill (a density below 1 percent counts as 1). The standard
    /// deviation is that of a finger yet to be printed: model error and scatter together.
    ///
    /// # Errors
    /// If the model uses the computed stiffness and the finger cannot be computed.
    pub fn predict(&self, infill: Infill) -> Result<Prediction, InputError> {
        let along = |axis| {
            let Chosen { fitted, widen } = &self.chosen[axis as usize];
            let unit = if self.ratios { self.computed.stiffness(axis, infill)? } else { 1.0 };
            let Estimate { mean, sd } = fitted.predict(infill);
            Ok::<_, InputError>(Estimate { mean: mean * unit, sd: sd * widen * unit })
        };
        let (compliance, assembly) = (along(Axis::Compliance)?, along(Axis::Assembly)?);
        Ok(Prediction { compliance, assembly, hull_distance: self.hull.distance(infill) })
    }

    /// Returns the number of measured designs as text.
    pub fn counted(&self) -> String {
        input::counted(self.measurements.len(), "measured design")
    }

    /// Returns the leave-one-out error of the model used on an axis.
    pub fn chosen(&self, axis: Axis) -> Option<&Loo> {
        self.loo.iter().find(|row| row.axis == axis && row.chosen)
    }

    /// Returns the parameters of the model used on an axis, as text.
    pub fn describe(&self, axis: Axis) -> String {
        self.chosen[axis as usize].fitted.describe()
    }

    /// Returns the factor by which the predicted standard deviation of an axis was widened to fit the leave-one-out
    /// errors; 1 if it already fitted.
    pub fn widening(&self, axis: Axis) -> f64 {
        self.chosen[axis as usize].widen
    }
}
