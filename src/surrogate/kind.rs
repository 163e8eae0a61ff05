//! The candidates for the model of one axis.

use super::link::{Link, Sum};
use super::{Fitted, Measured, gp, ridge};
use crate::input::stiffness::Axis;

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

/// Fits one model on one axis, everything it has to choose included.
pub(super) fn fit_axis(
    axis: Axis,
    kind: ModelKind,
    measured: &Measured,
) -> Option<Box<dyn Fitted>> {
    let polynomial = |degree: u8, link: Link, penalties: &[f64]| {
        let fitted = ridge::fit(measured, degree, link, penalties)?;
        Some(Box::new(fitted) as Box<dyn Fitted>)
    };
    let positive = Link::new(Sum::Parallel, measured.targets());
    match kind {
        ModelKind::Linear => polynomial(1, Link::identity(), &[0.0]),
        ModelKind::RidgeLinear => polynomial(1, positive, &ridge::PENALTIES),
        ModelKind::RidgeQuadratic => polynomial(2, positive, &ridge::PENALTIES),
        ModelKind::GaussianProcess => {
            let fitted = gp::fit(axis, measured)?;
            Some(Box::new(fitted) as Box<dyn Fitted>)
        }
    }
}
