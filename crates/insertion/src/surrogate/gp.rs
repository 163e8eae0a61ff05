//! A Gaussian process about a physical mean.
//!
//! A finger is a row of walls filled with ribs. Ribs at angle `theta` to the
//! assembly direction z are a lamina; the mean uses the leading term of its
//! transformed properties (Jones, Mechanics of Composite Materials, Sec. 2.6),
//! and the density law of cellular solids (Gibson and Ashby, Cellular Solids,
//! Sec. 5.3: stiffness ~ density^n, n = 1 if the cell walls stretch, 2 if they bend).
//!
//! * Assembly (z) loads the ribs along their length. Walls and ribs share the
//!   load, so stiffnesses add (rule of mixtures), and the ribs give
//!   `Q11(theta) ~ cos^4 theta`: `k = a + b density cos^4 theta`.
//! * Compliance (y) bends the ribs, the soft direction of the lamina. Walls and
//!   ribs are passed by the same force, so compliances add, and the ribs give
//!   `S22(theta) ~ cos^4 theta`: `1/k = a + b density^-n cos^4 theta`. It grows
//!   with density and angle and levels off at the walls' stiffness. `n` is
//!   chosen by likelihood from 1 to 2.
//!
//! What the mean leaves is a Matern 5/2 process over (ln density, direction),
//! plus noise, so that rounded readings are not interpolated. All
//! hyperparameters come from a fixed grid by maximum likelihood: no random
//! restarts, so the fit is the same on every run.

use super::link::{Link, Sum};
use super::{Estimate, Fitted, Measured, infills};
use crate::stiffness::{Axis, Infill};
use egobox_gp::correlation_models::Matern52Corr;
use egobox_gp::mean_models::RegressionModel;
use egobox_gp::{GaussianProcess, GpParams, ThetaTuning};
use input::units::DEG;
use linfa::prelude::{Dataset, Fit};
use ndarray::{Array2, ArrayBase, Data, Ix1, Ix2, array};

/// Inverse correlation lengths tried, per standard deviation of the inputs.
const THETAS: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];
/// Ratios of noise to process variance tried; 10 leaves the mean alone.
const NUGGETS: [f64; 5] = [1e-6, 1e-3, 1e-1, 1.0, 10.0];
/// Readings have two or three digits: 25 N/mm is 25 +- 0.3, about 1 %. No
/// prediction claims less, even where the data happen to lie on the mean.
pub(super) const READING_SD: f64 = 0.01;
/// Densities below this are taken as this, percent: the law diverges at 0.
const LEAST_DENSITY: f64 = 1.0;

/// The mean `a + b feature`, where the feature is the first input; or `a` alone.
#[derive(Debug, Clone, Copy, Default)]
struct PhysicalMean {
    lamina: bool,
}

impl PhysicalMean {
    fn terms(self) -> usize {
        1 + usize::from(self.lamina)
    }
}

impl std::fmt::Display for PhysicalMean {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("PhysicalMean")
    }
}

impl RegressionModel<f64> for PhysicalMean {
    fn coefs(&self, x: &ArrayBase<impl Data<Elem = f64>, Ix2>) -> Array2<f64> {
        let mut terms = Array2::ones((x.nrows(), self.terms()));
        if self.lamina {
            terms.column_mut(1).assign(&x.column(0));
        }
        terms
    }

    fn jac(&self, x: &ArrayBase<impl Data<Elem = f64>, Ix1>) -> Array2<f64> {
        let mut jacobian = Array2::zeros((self.terms(), x.len()));
        if self.lamina {
            jacobian[[1, 0]] = 1.0;
        }
        jacobian
    }
}

/// A fitted process.
#[derive(Debug)]
pub(super) struct PhysicalProcess {
    link: Link,
    mean: PhysicalMean,
    exponent: f64,
    nugget: f64,
    process: GaussianProcess<f64, PhysicalMean, Matern52Corr>,
    /// `n / (n - terms)`: the likelihood's variance ignores the terms of the mean.
    unbias: f64,
}

/// The sum that holds along an axis, and the density exponents tried.
fn physics(axis: Axis) -> (Sum, &'static [f64]) {
    match axis {
        Axis::Assembly => (Sum::Parallel, &[1.0]),
        Axis::Compliance => (Sum::Series, &[-1.0, -1.25, -1.5, -1.75, -2.0]),
    }
}

/// Feature of the mean, then the inputs of the process.
fn inputs(infill: Infill, exponent: f64) -> [f64; 3] {
    let density = infill[0].max(LEAST_DENSITY);
    let lamina = (infill[1] * DEG).cos().powi(4);
    [(density / 20.0).powf(exponent) * lamina, density.ln(), infill[1]]
}

/// Fits stiffness about the lamina's mean; `None` if nothing can be fitted.
pub(super) fn fit(axis: Axis, measured: &Measured) -> Option<PhysicalProcess> {
    let (sum, exponents) = physics(axis);
    let link = Link::new(sum, measured.targets());
    fit_about(PhysicalMean { lamina: true }, link, exponents, measured)
}

/// Fits the ratio of measured and computed stiffness, about one number for all designs.
pub(super) fn fit_ratio(ratios: &Measured) -> Option<PhysicalProcess> {
    fit_about(PhysicalMean { lamina: false }, Link::logarithm(), &[1.0], ratios)
}

/// Maximum likelihood over the grid.
fn fit_about(
    mean: PhysicalMean,
    link: Link,
    exponents: &[f64],
    measured: &Measured,
) -> Option<PhysicalProcess> {
    let y = measured.targets().mapv(|k| link.forward(k));
    let spare = y.len().checked_sub(mean.terms()).filter(|&spare| spare > 0)?;
    let mut best: Option<PhysicalProcess> = None;
    for &exponent in exponents {
        let rows: Vec<[f64; 3]> =
            infills(measured).map(|infill| inputs(infill, exponent)).collect();
        let data = Dataset::new(Array2::from(rows), y.clone());
        for (theta, nugget) in THETAS.iter().flat_map(|&t| NUGGETS.map(|n| (t, n))) {
            // The kernel does not see the feature: its inverse length is 0.
            let fitted = GpParams::new(mean, Matern52Corr())
                .theta_tuning(ThetaTuning::Fixed(array![0.0, theta, theta]))
                .nugget(nugget)
                .fit(&data);
            let Ok(process) = fitted else { continue };
            let better = |old: &PhysicalProcess| process.likelihood() > old.process.likelihood();
            if process.likelihood().is_finite() && best.as_ref().is_none_or(better) {
                let unbias = y.len() as f64 / spare as f64;
                best = Some(PhysicalProcess { link, mean, exponent, nugget, process, unbias });
            }
        }
    }
    best
}

impl Fitted for PhysicalProcess {
    fn predict(&self, infill: Infill) -> Estimate {
        let x = Array2::from(vec![inputs(infill, self.exponent)]);
        let Ok((mean, variance)) = self.process.predict_valvar(&x) else {
            return Estimate { mean: f64::NAN, sd: f64::NAN };
        };
        let (mean, slope) = self.link.backward(mean[0]);
        // The nugget is the scatter of a finger yet to be printed and measured.
        let noise = self.nugget * self.process.variance();
        let link_sd = ((variance[0] + noise) * self.unbias).sqrt();
        Estimate { mean, sd: (slope * link_sd).hypot(READING_SD * mean) }
    }

    fn describe(&self) -> String {
        let mean = match self.link.sum() {
            Sum::Parallel => "k = a + b density^n cos^4(direction)",
            Sum::Series => "1/k = a + b density^n cos^4(direction)",
            Sum::Product => "ln(k / computed) = a",
        };
        let exponent = match self.mean.lamina {
            true => format!(", n = {}", self.exponent),
            false => String::new(),
        };
        format!(
            "mean {mean}{exponent}; Matern 5/2 of inverse length {} about it; noise / process variance {}",
            self.process.theta()[1],
            self.nugget,
        )
    }
}
