//! From infill to stiffness: models fitted to measured fingers at start-up.
//!
//! The measurements are per finger. Three steps, once per axis (assembly z,
//! compliance y):
//!
//! 1. fit each candidate of [`ModelKind`] to all measured designs;
//! 2. leave each design out in turn, refit everything (link, exponent,
//!    hyperparameters, penalty) without it, and predict it ([`Loo`]);
//! 3. keep the candidate with the smallest mean absolute percentage error.
//!
//! Nothing here is random, so equal measurements give bit-identical models.

mod gp;
mod hull;
mod link;
mod loo;
mod measurement;
mod model;
mod ridge;
#[cfg(test)]
mod tests;

pub use loo::Loo;
pub use measurement::{HEADER, MINIMUM, Measurement, SurrogateError, parse};
pub use model::{Model, fit};

/// The measured designs shipped with the program (`data/measured_stiffness.csv`).
pub const SHIPPED_CSV: &str = include_str!("../../data/measured_stiffness.csv");

/// Name of the shipped file, for messages.
pub const SHIPPED_FILE: &str = "data/measured_stiffness.csv";

/// A direction in which a finger yields.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axis {
    /// z, the direction of assembly: loads the ribs along their length.
    Assembly,
    /// y, the direction in which the jaws close: bends the ribs.
    Compliance,
}

impl Axis {
    /// Both axes, assembly first, as in the measured file.
    pub const ALL: [Axis; 2] = [Axis::Assembly, Axis::Compliance];

    /// A short name for tables and plots.
    pub fn label(self) -> &'static str {
        match self {
            Axis::Assembly => "assembly (z)",
            Axis::Compliance => "compliance (y)",
        }
    }
}

/// A model of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ModelKind {
    /// `k = a + b density + c direction` by least squares: what the others are
    /// measured against. Never chosen, since it turns negative outside the data.
    Linear,
    /// The same terms with a ridge penalty, through a link that stays positive.
    RidgeLinear,
    /// All terms up to second degree with a ridge penalty, through the same link.
    RidgeQuadratic,
    /// A Gaussian process about a physical mean.
    GaussianProcess,
}

impl ModelKind {
    /// All models, simplest first.
    pub const ALL: [ModelKind; 4] = [
        ModelKind::Linear,
        ModelKind::RidgeLinear,
        ModelKind::RidgeQuadratic,
        ModelKind::GaussianProcess,
    ];

    /// A short name for tables.
    pub fn label(self) -> &'static str {
        match self {
            ModelKind::Linear => "linear (reference)",
            ModelKind::RidgeLinear => "ridge, degree 1",
            ModelKind::RidgeQuadratic => "ridge, degree 2",
            ModelKind::GaussianProcess => "Gaussian process, physical mean",
        }
    }
}

/// A value with its standard deviation, both in the same unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Expected value.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
}

/// Predicted stiffness of one finger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// In the compliance direction (y), N/m.
    pub compliance: Estimate,
    /// In the assembly direction (z), N/m.
    pub assembly: Estimate,
    /// Distance to the convex hull of the measured designs, in units of the
    /// measured spans (density span = direction span = 1); 0 inside.
    pub hull_distance: f64,
}

impl Prediction {
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

/// Infill of a finger: density in percent, direction in degrees.
type Infill = [f64; 2];

/// A fitted model of one axis; stiffness in N/m.
trait Fitted: std::fmt::Debug + Send + Sync {
    /// Mean and standard deviation for a finger yet to be printed.
    fn predict(&self, infill: Infill) -> Estimate;

    /// Its parameters, in words.
    fn describe(&self) -> String;
}
