#![doc = include_str!("../README.md")]

pub mod cmaes;
pub mod gp;
mod kind;
mod lattice;
mod nelder_mead;
pub mod normal;
pub mod pareto;
mod polish;
pub mod process;
mod proposed;
pub mod protocol;
mod seeded;
mod sequence;
mod sobol;
pub mod statistics;
pub mod stream;

pub use kind::{OptimizerKind, build, build_for};
pub use polish::Polished;
pub use seeded::SeededOptimizer;
pub use sobol::SobolSequence;

use serde::{Deserialize, Serialize};

/// One point of a grid: a level per axis, in the order of the axes.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct GridPoint(pub Vec<u32>);

/// The grid of the unit cube: axis `i` has `levels[i]` values
/// `k / (levels[i] - 1)`, `k = 0 .. levels[i]`. An axis with one level is fixed at 0.5.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Grid {
    levels: Vec<u32>,
}

impl Grid {
    /// Creates a grid with at least one level on each axis (zero counts as one).
    pub fn new(levels: Vec<u32>) -> Self {
        Grid { levels: levels.into_iter().map(|n| n.max(1)).collect() }
    }

    /// Returns the number of levels of each axis.
    pub fn levels(&self) -> &[u32] {
        &self.levels
    }

    /// Returns the number of axes.
    pub fn dimension(&self) -> usize {
        self.levels.len()
    }

    /// Returns the number of points, saturating at `u64::MAX`.
    pub fn size(&self) -> u64 {
        self.levels.iter().fold(1, |n, &l| n.saturating_mul(u64::from(l)))
    }

    /// Returns the unit-cube coordinates of a grid point.
    pub fn unit(&self, point: &GridPoint) -> Vec<f64> {
        let coordinate = |(&k, &n): (&u32, &u32)| {
            if n == 1 { 0.5 } else { f64::from(k) / f64::from(n - 1) }
        };
        point.0.iter().zip(&self.levels).map(coordinate).collect()
    }

    /// Returns whether `point` has one level per axis, each below the axis' count.
    pub fn contains(&self, point: &GridPoint) -> bool {
        point.0.len() == self.levels.len() && point.0.iter().zip(&self.levels).all(|(k, n)| k < n)
    }

    /// Returns the grid point whose cell contains `unit`. Each axis is divided into `levels[i]`
    /// equal cells, so that all levels are equally likely for a uniform `unit` (with
    /// [`snap`](Self::snap) the two end levels are half as likely). Coordinates outside [0, 1] are
    /// clamped.
    pub fn cell(&self, unit: &[f64]) -> GridPoint {
        let level = |(&u, &n): (&f64, &u32)| ((u.max(0.0) * f64::from(n)) as u32).min(n - 1);
        GridPoint(unit.iter().zip(&self.levels).map(level).collect())
    }

    /// Returns the axes with more than one level.
    pub(crate) fn free_axes(&self) -> Vec<usize> {
        (0..self.dimension()).filter(|&axis| self.levels[axis] > 1).collect()
    }

    /// Returns the coordinates of a grid point on the free axes.
    pub(crate) fn free_unit(&self, point: &GridPoint) -> Vec<f64> {
        let axes = self.unit(point).into_iter().zip(&self.levels);
        axes.filter(|&(_, &levels)| levels > 1).map(|(unit, _)| unit).collect()
    }

    /// Returns all points in lexicographic order.
    pub fn points(&self) -> impl Iterator<Item = GridPoint> {
        let first = GridPoint(vec![0; self.dimension()]);
        std::iter::successors(Some(first), |point| self.after(point))
    }

    /// Returns the next point in lexicographic order.
    pub(crate) fn after(&self, point: &GridPoint) -> Option<GridPoint> {
        let mut next = point.clone();
        for (k, &n) in next.0.iter_mut().zip(&self.levels).rev() {
            if *k + 1 < n {
                *k += 1;
                return Some(next);
            }
            *k = 0;
        }
        None
    }

    /// Returns the grid point nearest to a point of R^n, one coordinate for each free axis, folded onto
    /// the cube by reflection at its faces (`x -> |x - 2 round(x / 2)|`).
    pub(crate) fn folded(&self, x: &[f64]) -> GridPoint {
        let mut unit = vec![0.5; self.dimension()];
        for (axis, x) in self.free_axes().into_iter().zip(x) {
            unit[axis] = (x - 2.0 * (x / 2.0).round()).abs();
        }
        self.snap(&unit)
    }

    /// Returns the grid point nearest to `unit`; coordinates outside [0, 1] are clamped.
    pub fn snap(&self, unit: &[f64]) -> GridPoint {
        let level = |(&u, &n): (&f64, &u32)| (u.clamp(0.0, 1.0) * f64::from(n - 1)).round() as u32;
        GridPoint(unit.iter().zip(&self.levels).map(level).collect())
    }
}

/// Result of the evaluation of a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// The point.
    pub point: GridPoint,
    /// Objective values, larger is better; empty if the evaluation failed (for example diverged).
    pub values: Vec<f64>,
    /// Violation of each constraint; 0 or below if it is satisfied.
    pub violations: Vec<f64>,
}

/// Merit of an infeasible point before its violation is subtracted: below any objective value.
const INFEASIBLE: f64 = -1e9;

impl Observation {
    /// Creates an observation of a single objective without constraints.
    pub fn new(point: GridPoint, value: Option<f64>) -> Self {
        Observation { point, values: value.into_iter().collect(), violations: Vec::new() }
    }

    /// Returns the first objective value.
    pub fn value(&self) -> Option<f64> {
        self.values.first().copied()
    }

    /// Returns whether the observation has a value and satisfies all constraints.
    pub fn feasible(&self) -> bool {
        !self.values.is_empty() && self.violations.iter().all(|&violation| violation <= 0.0)
    }

    /// Returns a single merit for optimizers without constraint handling, by the feasibility rules
    /// of K. Deb 2000 (Comput. Methods Appl. Mech. Eng. 186:311): of two feasible points the larger
    /// value is better, a feasible point is better than an infeasible one, and of two infeasible
    /// points the smaller sum of violations is better.
    pub fn merit(&self) -> Option<f64> {
        let violation: f64 = self.violations.iter().map(|violation| violation.max(0.0)).sum();
        let value = self.value()?;
        Some(if violation > 0.0 { INFEASIBLE - violation } else { value })
    }
}

/// Reason why an optimizer has nothing more to propose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StopReason {
    /// Every point of the grid has been proposed.
    #[serde(rename = "space_exhausted")]
    GridExhausted,
    /// The search has converged.
    Converged,
}

/// A sequential optimizer over a [`Grid`].
///
/// Contract, checked for every implementation by `tests/optimizers.rs`: proposals depend only on
/// the constructor's arguments and the sequence of calls; every proposed point lies on the grid
/// and is proposed once; fewer than `n` points are returned only when the grid is exhausted (or,
/// for [`Polished`], when its search or its polishing phase ends).
pub trait Optimizer {
    /// Proposes up to `n` new points.
    fn ask(&mut self, n: usize) -> Vec<GridPoint>;

    /// Reports the results of all points of the last [`ask`](Self::ask), in its order; or, when no
    /// results are pending, those of points that were evaluated without a proposal, which are then no longer
    /// proposed.
    fn tell(&mut self, observations: &[Observation]);

    /// Returns the reason why there is nothing more to propose, if the search has ended.
    fn stop(&self) -> Option<StopReason>;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folding_reflects_at_both_faces() {
        let grid = Grid::new(vec![101, 1]);
        for (x, level) in [(0.3, 30), (-0.3, 30), (1.25, 75), (2.5, 50), (-1.75, 25)] {
            assert_eq!(grid.folded(&[x]), GridPoint(vec![level, 0]));
        }
    }

    #[test]
    fn merit_puts_feasible_points_first_and_then_the_smaller_violation() {
        let of = |value: Option<f64>, violations: &[f64]| Observation {
            violations: violations.to_vec(),
            ..Observation::new(GridPoint(vec![0]), value)
        };
        let ordered = [
            of(Some(3.0), &[-1.0, 0.0]),
            of(Some(-1e6), &[]),
            of(Some(9.0), &[0.1, -5.0]),
            of(Some(9.0), &[0.1, 0.1]),
        ];
        let merits: Vec<f64> = ordered.iter().filter_map(Observation::merit).collect();
        assert_eq!(merits.len(), 4);
        assert!(merits.windows(2).all(|pair| pair[0] > pair[1]), "{merits:?}");
        assert_eq!(merits[0], 3.0);
        assert_eq!(of(None, &[]).merit(), None);
        let feasible: Vec<bool> = ordered.iter().map(Observation::feasible).collect();
        assert_eq!(feasible, [true, true, false, false]);
        assert!(!of(None, &[-1.0]).feasible());
    }
}
