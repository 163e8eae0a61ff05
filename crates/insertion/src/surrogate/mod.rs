//! From infill to stiffness: models fitted to measured fingers at start-up.
//!
//! The measurements are per finger. Three steps, once per axis (assembly z,
//! compliance y), of at least seven fingers:
//!
//! 1. fit each candidate of [`ModelKind`] to all measured designs;
//! 2. leave each design out in turn, refit everything (link, exponent,
//!    hyperparameters, penalty) without it, and predict it ([`Loo`]);
//! 3. keep the candidate with the smallest mean absolute percentage error.
//!
//! Of fewer than seven fingers the models are of measured / computed stiffness: the ribs give the
//! shape ([`Computed`]), the fingers its scale (`docs/notes/finger.md`).
//!
//! Nothing here is random, so equal measurements give bit-identical models.

mod computed;
mod gp;
mod hull;
mod kind;
mod link;
mod loo;
mod model;
mod ridge;
mod row;
mod scale;
mod standard;
#[cfg(test)]
mod tests;

use crate::stiffness::{Axis, Infill};
use linfa::prelude::Dataset;
use ndarray::{Array1, Array2, Ix1};
use rayon::prelude::*;

use computed::Computed;
pub use kind::ModelKind;
pub use loo::Loo;
pub use model::{ENOUGH, Model, fit};
pub(crate) use row::null_is_nan;

/// A value with its standard deviation, both in the same unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Expected value.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
}

/// Predicted stiffness of one finger. Written in the one form of `row.rs`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(into = "row::StiffnessRow", from = "row::StiffnessRow")]
pub struct Prediction {
    /// In the compliance direction (y), N/m.
    pub compliance: Estimate,
    /// In the assembly direction (z), N/m.
    pub assembly: Estimate,
    /// Distance to the hull of the measured designs, in units of the measured spans; 0 inside.
    pub hull_distance: f64,
}

impl Prediction {
    /// A stiffness that is known, N/m.
    pub fn exact(compliance: f64, assembly: f64) -> Self {
        let exact = |mean| Estimate { mean, sd: 0.0 };
        Prediction { compliance: exact(compliance), assembly: exact(assembly), hull_distance: 0.0 }
    }

    /// Whether the design lies inside the hull of the measured designs.
    pub fn inside_hull(&self) -> bool {
        self.hull_distance == 0.0
    }

    /// The estimate of one axis, N/m.
    pub fn axis(&self, axis: Axis) -> Estimate {
        match axis {
            Axis::Assembly => self.assembly,
            Axis::Compliance => self.compliance,
        }
    }
}

/// Designs (density in percent, direction in degrees) and their stiffness along one axis, N/m.
type Measured = Dataset<f64, f64, Ix1>;

fn measured(infills: &[Infill], stiffness: &[f64]) -> Measured {
    Dataset::new(Array2::from(infills.to_vec()), Array1::from(stiffness.to_vec()))
}

/// The infill of each design.
fn infills(measured: &Measured) -> impl Iterator<Item = Infill> {
    measured.records().rows().into_iter().map(|row| [row[0], row[1]])
}

/// A fitted model of one axis; stiffness in N/m.
trait Fitted: std::fmt::Debug + Send + Sync {
    /// Mean and standard deviation for a finger yet to be printed.
    fn predict(&self, infill: Infill) -> Estimate;

    /// Its parameters, in words.
    fn describe(&self) -> String;
}

/// Each design predicted by a model of the others; no numbers where there is no model.
fn left_out(
    measured: &Measured,
    predict: impl Fn(&Measured, Infill) -> Option<Estimate> + Sync,
) -> Vec<Estimate> {
    let nothing = Estimate { mean: f64::NAN, sd: f64::NAN };
    let count = measured.targets().len();
    // Without one of one there is nothing to fit to.
    let folds = if count > 1 { measured.fold(count) } else { Vec::new() };
    let one = |(others, one): (Measured, Measured)| predict(&others, infills(&one).next()?);
    // Collected by index: the thread count changes nothing.
    let mut predicted: Vec<Estimate> =
        folds.into_par_iter().map(|fold| one(fold).unwrap_or(nothing)).collect();
    predicted.resize(count, nothing);
    predicted
}
