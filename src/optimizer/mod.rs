//! Optimizers behind one ask / tell trait.
//!
//! They maximise. They know the unit cube, the number of levels per axis and
//! the numbers they are told, and nothing of fingers or tasks.

pub mod cmaes;
pub mod gp;
mod kind;
mod lattice;
mod neldermead;
mod polish;
mod proposed;
mod random;
mod simplex;
mod sobol;

pub use kind::{OptimizerKind, UnknownOptimizer, build};
pub use lattice::GridSearch;
pub use neldermead::NelderMeadOptimizer;
pub use polish::Polished;
pub use proposed::Proposed;
pub use random::RandomSearch;
pub use sobol::SobolSearch;

use crate::space::GridPoint;

/// The grid of the unit cube: axis `i` has `levels[i]` values
/// `k / (levels[i] - 1)`, `k = 0 .. levels[i]`. An axis with one level is fixed at 0.5.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Grid {
    levels: Vec<u32>,
}

impl Grid {
    /// A grid with at least one level on each axis (zero counts as one).
    pub fn new(levels: Vec<u32>) -> Self {
        Grid { levels: levels.into_iter().map(|n| n.max(1)).collect() }
    }

    /// Levels per axis.
    pub fn levels(&self) -> &[u32] {
        &self.levels
    }

    /// Number of axes.
    pub fn dimension(&self) -> usize {
        self.levels.len()
    }

    /// Number of points; saturates.
    pub fn size(&self) -> u64 {
        self.levels.iter().fold(1, |n, &l| n.saturating_mul(u64::from(l)))
    }

    /// Unit-cube coordinates of a grid point.
    pub fn unit(&self, point: &GridPoint) -> Vec<f64> {
        let coordinate = |(&k, &n): (&u32, &u32)| {
            if n == 1 { 0.5 } else { f64::from(k) / f64::from(n - 1) }
        };
        point.0.iter().zip(&self.levels).map(coordinate).collect()
    }

    /// Whether `point` has one level per axis, each below the axis' count.
    pub fn contains(&self, point: &GridPoint) -> bool {
        point.0.len() == self.levels.len() && point.0.iter().zip(&self.levels).all(|(k, n)| k < n)
    }

    /// The grid point whose cell holds `unit`: each axis is cut into `levels[i]` equal cells,
    /// so that a uniform `unit` gives every level the same chance ([`snap`](Self::snap) gives
    /// the two end levels half of one). Coordinates outside [0, 1] are clamped.
    pub fn cell(&self, unit: &[f64]) -> GridPoint {
        let level = |(&u, &n): (&f64, &u32)| ((u.max(0.0) * f64::from(n)) as u32).min(n - 1);
        GridPoint(unit.iter().zip(&self.levels).map(level).collect())
    }

    /// The grid point nearest to `unit`; coordinates outside [0, 1] are clamped.
    pub fn snap(&self, unit: &[f64]) -> GridPoint {
        let level = |(&u, &n): (&f64, &u32)| (u.clamp(0.0, 1.0) * f64::from(n - 1)).round() as u32;
        GridPoint(unit.iter().zip(&self.levels).map(level).collect())
    }
}

/// What an optimizer is told of one point it asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// The point.
    pub point: GridPoint,
    /// The objective, larger is better; `None` if the evaluation gave no value
    /// (it diverged, or broke): known to be bad, not known how bad.
    pub value: Option<f64>,
}

/// Why an optimizer has nothing more to propose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// Every point of the grid has been proposed.
    GridExhausted,
    /// It has found what it can find.
    Converged,
}

/// A sequential optimizer over a [`Grid`].
///
/// Contract, checked for every implementation by `tests/optimizers.rs`:
/// proposals depend only on the constructor's arguments and the sequence of
/// calls; every proposed point lies on the grid and is proposed once; fewer
/// than `n` points come back only when the grid is exhausted (or, of [`Polished`],
/// where its search or its polish ends).
pub trait Optimizer {
    /// Proposes up to `n` new points.
    fn ask(&mut self, n: usize) -> Vec<GridPoint>;

    /// Reports the values of all points of the last [`ask`](Self::ask), in its order.
    fn tell(&mut self, observations: &[Observation]);

    /// Why there is nothing more to ask for, if so.
    fn stop(&self) -> Option<StopReason>;
}
