//! Gaussian process with a physical mean function.
//!
//! A finger is a row of walls filled with ribs. Ribs at angle `theta` to the assembly direction z
//! are a lamina; the mean uses the leading term of its transformed properties (Jones, Mechanics of
//! Composite Materials, Sec. 2.6), and the density law of cellular solids (Gibson and Ashby,
//! Cellular Solids, Sec. 5.3: stiffness ~ density^n, n = 1 if the walls stretch, 2 if they bend).
//!
//! * Assembly (z) loads the ribs along their length. Walls and ribs share the
//!   load, so stiffnesses add (rule of mixtures), and the ribs give
//!   `Q11(theta) ~ cos^4 theta`: `k = a + b density cos^4 theta`.
//! * Compliance (y) bends the ribs, the soft direction of the lamina. The same
//!   force passes through walls and ribs, so compliances add, and the ribs give
//!   `S22(theta) ~ cos^4 theta`: `1/k = a + b density^-n cos^4 theta`. It grows
//!   with density and angle and levels off at the walls' stiffness. `n` is
//!   chosen by likelihood from 1 to 2.
//!
//! Residual of the mean: a Matern 5/2 process over (ln density, direction), plus noise, so that
//! rounded readings are not interpolated. All hyperparameters come from a fixed grid by maximum
//! likelihood: no random restarts, so the fit is the same on every run.

use super::link::{Link, LinkKind};
use super::{Estimate, Fitted, Samples, Standardizer, infills};
use crate::stiffness::{Axis, Infill};
use ask_tell::process::{Process, matern52};
use input::units::DEG;
use nalgebra::{DMatrix, DVector};

/// Inverse correlation lengths tried, per standard deviation of the inputs.
const THETAS: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];
/// Ratios of noise to process variance tried; at 10 the prediction is nearly the mean function.
const NUGGETS: [f64; 5] = [1e-6, 1e-3, 1e-1, 1.0, 10.0];
/// Smallest relative standard deviation of a prediction: a reading of two or three digits, 25 N/mm, is 25 +- 0.3.
/// Without this limit it would vanish if the data happen to lie on the mean.
pub(super) const READING_SD: f64 = 0.01;
/// Smallest density that is used, percent: the law diverges at 0.
const MIN_DENSITY: f64 = 1.0;

#[derive(Debug, Clone, Copy)]
struct Hyperparameters {
    /// Exponent of the density in the feature (the stiffness or compliance of the lamina).
    exponent: f64,
    /// Inverse correlation length, not the angle of the ribs.
    theta: f64,
    /// Ratio of noise to process variance.
    nugget: f64,
}

/// A fitted process about the mean `a + b feature`, or about `a` alone (`P = 1`).
#[derive(Debug)]
pub(super) struct PhysicalProcess<const P: usize> {
    link: Link,
    hyperparameters: Hyperparameters,
    /// Standardisation of the feature and of the inputs.
    scales: [Standardizer; 3],
    /// Standardisation of the values on the scale of the link.
    target: Standardizer,
    points: Vec<ScaledInfill>,
    /// Process of the standardised values, in units of the process variance.
    process: Process<P>,
}

/// Inputs of the process, in correlation lengths.
type ScaledInfill = [f64; 2];

/// Returns the correlation of two points, a product over the inputs.
fn correlation(a: &ScaledInfill, b: &ScaledInfill) -> f64 {
    a.iter().zip(b).map(|(a, b)| matern52((a - b) * (a - b))).product()
}

/// Returns the feature of the mean, then the inputs of the process.
fn inputs(infill: Infill, exponent: f64) -> [f64; 3] {
    let density = infill[0].max(MIN_DENSITY);
    let lamina = libm::cos(infill[1] * DEG).powi(4);
    [libm::pow(density / 20.0, exponent) * lamina, libm::log(density), infill[1]]
}

/// Fits a process whose mean is the law of walls and ribs; `None` if no process can be fitted.
pub(super) fn fit(axis: Axis, measured: &Samples) -> Option<PhysicalProcess<2>> {
    let (kind, exponents): (_, &[f64]) = match axis {
        Axis::Assembly => (LinkKind::Identity, &[1.0]),
        Axis::Compliance => (LinkKind::Inverse, &[-1.0, -1.25, -1.5, -1.75, -2.0]),
    };
    fit_about(Link::new(kind, measured.targets()), exponents, measured)
}

/// Fits a process with a constant mean to ratios of measured to computed stiffness.
pub(super) fn fit_ratio(ratios: &Samples) -> Option<PhysicalProcess<1>> {
    fit_about(Link { kind: LinkKind::Log, scale: None }, &[1.0], ratios)
}

/// Fits a process for each combination of hyperparameters; returns the one of highest likelihood.
fn fit_about<const P: usize>(
    link: Link,
    exponents: &[f64],
    measured: &Samples,
) -> Option<PhysicalProcess<P>> {
    let kernels = || THETAS.into_iter().flat_map(|theta| NUGGETS.map(|nugget| (theta, nugget)));
    let candidates = exponents.iter().flat_map(|&exponent| {
        kernels().map(move |(theta, nugget)| Hyperparameters { exponent, theta, nugget })
    });
    candidates
        .filter_map(|candidate| PhysicalProcess::new(link, candidate, measured))
        .map(|fitted| (fitted.process.profile_log_likelihood(), fitted))
        .filter(|(likelihood, _)| likelihood.is_finite())
        .reduce(|best, next| if next.0 > best.0 { next } else { best })
        .map(|(_, fitted)| fitted)
}

impl<const P: usize> PhysicalProcess<P> {
    /// Fits the process; `None` if the designs are too few.
    fn new(link: Link, candidate: Hyperparameters, measured: &Samples) -> Option<Self> {
        let rows: Vec<[f64; 3]> =
            infills(measured).map(|infill| inputs(infill, candidate.exponent)).collect();
        let values: Vec<f64> = measured.targets().iter().map(|&k| link.forward(k)).collect();
        let n = Some(values.len()).filter(|&n| n > P)?;
        let of_column = |i: usize| Standardizer::of(rows.iter().map(move |row| row[i]), 1);
        let target = Standardizer::of(values.iter().copied(), 1);
        let scales = std::array::from_fn(of_column);
        let (terms, points): (Vec<[f64; P]>, Vec<ScaledInfill>) =
            rows.iter().map(|&row| scaled(row, &scales, candidate.theta)).unzip();
        let noise = |i, j| if i == j { candidate.nugget } else { 0.0 };
        let covariance =
            DMatrix::from_fn(n, n, |i, j| correlation(&points[i], &points[j]) + noise(i, j));
        let values: Vec<f64> = values.into_iter().map(|value| target.apply(value)).collect();
        let process = Process::new(covariance, &terms, &values)?;
        Some(PhysicalProcess { link, hyperparameters: candidate, scales, target, points, process })
    }
}

fn scaled<const P: usize>(
    row: [f64; 3],
    scales: &[Standardizer; 3],
    theta: f64,
) -> ([f64; P], ScaledInfill) {
    let [feature, u, v]: [f64; 3] = std::array::from_fn(|i| scales[i].apply(row[i]));
    (std::array::from_fn(|term| if term == 0 { 1.0 } else { feature }), [theta * u, theta * v])
}

impl<const P: usize> Fitted for PhysicalProcess<P> {
    fn predict(&self, infill: Infill) -> Estimate {
        let Hyperparameters { exponent, theta, nugget } = self.hyperparameters;
        let (terms, point) = scaled(inputs(infill, exponent), &self.scales, theta);
        let cross = self.points.iter().map(|measured| correlation(measured, &point));
        let cross = DVector::from_iterator(self.points.len(), cross);
        let mean = self.target.mean + self.target.sd * self.process.mean(&cross, &terms);
        // The nugget is the scatter of a finger yet to be printed and measured.
        let variance = self.process.scale() * (self.process.variance(&cross, &terms, 1.0) + nugget);
        let (mean, slope) = self.link.backward(mean);
        let link_sd = self.target.sd * variance.sqrt();
        Estimate { mean, sd: libm::hypot(slope * link_sd, READING_SD * mean) }
    }

    fn describe(&self) -> String {
        let mean = match self.link.kind {
            LinkKind::Identity => "k = a + b density^n cos^4(direction)",
            LinkKind::Inverse => "1/k = a + b density^n cos^4(direction)",
            LinkKind::Log => "ln(k / computed) = a",
        };
        let Hyperparameters { exponent, theta, nugget } = self.hyperparameters;
        let exponent = if P > 1 { format!(", n = {exponent}") } else { String::new() };
        format!(
            "mean {mean}{exponent}; Matern 5/2 of inverse length {theta} about it; \
             noise / process variance {nugget}"
        )
    }
}
