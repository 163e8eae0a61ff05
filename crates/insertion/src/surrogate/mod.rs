//! From infill to stiffness: models fitted to measured fingers at start-up.
//!
//! With at least seven fingers, three steps for each axis (assembly z, compliance y):
//!
//! 1. fit each candidate of [`ModelKind`] to all measured designs;
//! 2. leave each design out in turn, refit everything (link, exponent,
//!    hyperparameters, penalty) without it, and predict it ([`Loo`]);
//! 3. keep the candidate with the smallest mean absolute percentage error.
//!
//! With fewer than seven fingers, the models predict the ratio of measured to computed stiffness: the ribs
//! determine the shape, the measurements its scale (`docs/notes/finger.md`).
//!
//! Nothing here is random, so equal measurements give bit-identical models.

mod computed;
mod gp;
mod hull;
mod link;
mod model;
mod ridge;
#[cfg(test)]
mod tests;

use crate::stiffness::{Axis, Infill};
use ask_tell::statistics::Moments;
use input::units::N_PER_MM;
use linfa::prelude::Dataset;
use ndarray::{Array1, Array2, Ix1};
use rayon::prelude::*;
use serde::{Deserialize, Deserializer, Serialize};

pub use model::{Loo, MIN_MEASURED, Model, ModelKind, fit};

/// A value with its standard deviation, both in the same unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Expected value.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
}

/// Predicted stiffness of one finger, serialized as a `StiffnessRow`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "StiffnessRow", from = "StiffnessRow")]
pub struct Prediction {
    /// Stiffness in the compliance direction (y), N/m.
    pub compliance: Estimate,
    /// Stiffness in the assembly direction (z), N/m.
    pub assembly: Estimate,
    /// Distance to the hull of the measured designs, in units of the measured spans; 0 inside.
    pub hull_distance: f64,
}

impl Prediction {
    /// Creates the prediction of a stiffness that is known exactly, N/m.
    pub fn exact(compliance: f64, assembly: f64) -> Self {
        let exact = |mean| Estimate { mean, sd: 0.0 };
        Prediction { compliance: exact(compliance), assembly: exact(assembly), hull_distance: 0.0 }
    }

    /// Returns mean and standard deviation, N/m, of the stiffness at the pad, in the compliance direction (across the
    /// pad's face) and in the assembly direction (along it).
    pub fn at_pad(&self) -> [[f64; 2]; 2] {
        [self.compliance, self.assembly].map(|Estimate { mean, sd }| [mean, sd])
    }

    /// Returns whether the design lies inside the hull of the measured designs.
    pub fn inside_hull(&self) -> bool {
        self.hull_distance == 0.0
    }

    /// Returns the estimate of one axis, N/m.
    pub fn axis(&self, axis: Axis) -> Estimate {
        [self.assembly, self.compliance][axis as usize]
    }
}

/// A [`Prediction`] in N/mm, to six decimals.
#[derive(Serialize, Deserialize)]
struct StiffnessRow {
    #[serde(deserialize_with = "null_is_nan")]
    compliance_n_per_mm: f64,
    #[serde(deserialize_with = "null_is_nan")]
    compliance_sd_n_per_mm: f64,
    #[serde(deserialize_with = "null_is_nan")]
    assembly_n_per_mm: f64,
    #[serde(deserialize_with = "null_is_nan")]
    assembly_sd_n_per_mm: f64,
    #[serde(deserialize_with = "null_is_nan")]
    hull_distance: f64,
    inside_hull: bool,
}

/// Deserializes NaN from null, since JSON has no NaN.
pub(crate) fn null_is_nan<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

impl From<Prediction> for StiffnessRow {
    fn from(stiffness: Prediction) -> Self {
        // Rounded to 1e-6 N/mm, so that values do not change in a round trip.
        let n_per_mm = |n_per_m: f64| (n_per_m / N_PER_MM * 1e6).round() / 1e6;
        StiffnessRow {
            compliance_n_per_mm: n_per_mm(stiffness.compliance.mean),
            compliance_sd_n_per_mm: n_per_mm(stiffness.compliance.sd),
            assembly_n_per_mm: n_per_mm(stiffness.assembly.mean),
            assembly_sd_n_per_mm: n_per_mm(stiffness.assembly.sd),
            hull_distance: stiffness.hull_distance,
            inside_hull: stiffness.inside_hull(),
        }
    }
}

impl From<StiffnessRow> for Prediction {
    fn from(row: StiffnessRow) -> Self {
        let estimate = |mean: f64, sd: f64| Estimate { mean: mean * N_PER_MM, sd: sd * N_PER_MM };
        Prediction {
            compliance: estimate(row.compliance_n_per_mm, row.compliance_sd_n_per_mm),
            assembly: estimate(row.assembly_n_per_mm, row.assembly_sd_n_per_mm),
            hull_distance: row.hull_distance,
        }
    }
}

/// Measured designs (density in percent, direction in degrees) and their stiffness along one axis, N/m, or its ratio
/// to the computed stiffness.
type Samples = Dataset<f64, f64, Ix1>;

fn samples(infills: &[Infill], stiffness: &[f64]) -> Samples {
    Dataset::new(Array2::from(infills.to_vec()), Array1::from(stiffness.to_vec()))
}

fn infills(measured: &Samples) -> impl Iterator<Item = Infill> {
    measured.records().rows().into_iter().map(|row| [row[0], row[1]])
}

/// Fitted model of the stiffness along one axis, N/m, or of its ratio to the computed stiffness.
trait Fitted: std::fmt::Debug + Send + Sync {
    /// Predicts the value for a new finger: mean and standard deviation.
    fn predict(&self, infill: Infill) -> Estimate;

    /// Returns the parameters of the model as text.
    fn describe(&self) -> String;
}

/// Predicts each design by a model of the others; NaN if there is no model.
fn leave_one_out(
    measured: &Samples,
    predict: impl Fn(&Samples, Infill) -> Option<Estimate> + Sync,
) -> Vec<Estimate> {
    let nothing = Estimate { mean: f64::NAN, sd: f64::NAN };
    let count = measured.targets().len();
    // A single design leaves none to fit to.
    let folds = if count > 1 { measured.fold(count) } else { Vec::new() };
    let one = |(others, one): (Samples, Samples)| predict(&others, infills(&one).next()?);
    // Collected by index: the thread count changes nothing.
    let mut predicted: Vec<Estimate> =
        folds.into_par_iter().map(|fold| one(fold).unwrap_or(nothing)).collect();
    predicted.resize(count, nothing);
    predicted
}

/// Shift and scale that bring values to mean 0 and standard deviation 1.
#[derive(Debug, Clone, Copy)]
struct Standardizer {
    /// Mean of the values.
    pub mean: f64,
    /// Their standard deviation; 1 if all values are equal.
    pub sd: f64,
}

impl Standardizer {
    /// Computes shift and scale of values; the variance is the sum of squares divided by the count minus `ddof`.
    pub fn of(values: impl Iterator<Item = f64> + Clone, ddof: usize) -> Self {
        let Moments { count, mean, squares } = Moments::of(values);
        let variance = squares / (count - ddof as f64);
        Standardizer { mean, sd: if variance > 0.0 { variance.sqrt() } else { 1.0 } }
    }

    /// Returns the deviation of a value from the mean, in standard deviations.
    pub fn apply(self, value: f64) -> f64 {
        (value - self.mean) / self.sd
    }
}
