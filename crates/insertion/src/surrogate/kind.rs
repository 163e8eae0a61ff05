//! The candidates for the model of one axis.

use super::link::{Link, Sum};
use super::{Fitted, Measured, gp, ridge, scale};
use crate::stiffness::Axis;

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
    /// The computed stiffness times one number.
    ComputedScale,
    /// A Gaussian process of the logarithm of measured / computed about one number.
    ComputedProcess,
}

impl ModelKind {
    /// The models that know nothing of ribs, simplest first.
    pub const MEASURED: [ModelKind; 4] = [
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
            ModelKind::ComputedScale => "computed, scaled",
            ModelKind::ComputedProcess => "Gaussian process, computed mean",
        }
    }
}

/// Fits one model on one axis; of a computed kind to ratios of measured and computed stiffness.
pub(super) fn fit_axis(
    axis: Axis,
    kind: ModelKind,
    measured: &Measured,
) -> Option<Box<dyn Fitted>> {
    fn boxed<F: Fitted + 'static>(fitted: Option<F>) -> Option<Box<dyn Fitted>> {
        fitted.map(|fitted| Box::new(fitted) as Box<dyn Fitted>)
    }
    let positive = Link::new(Sum::Parallel, measured.targets());
    match kind {
        ModelKind::Linear => boxed(ridge::fit(measured, 1, Link::IDENTITY, &[0.0])),
        ModelKind::RidgeLinear => boxed(ridge::fit(measured, 1, positive, &ridge::PENALTIES)),
        ModelKind::RidgeQuadratic => boxed(ridge::fit(measured, 2, positive, &ridge::PENALTIES)),
        ModelKind::GaussianProcess => boxed(gp::fit(axis, measured)),
        ModelKind::ComputedScale => boxed(scale::fit(axis, measured)),
        ModelKind::ComputedProcess => boxed(gp::fit_ratio(measured)),
    }
}
