//! Search for the grid point with the largest acquisition.

use super::lbfgs::{Limits, minimise};
use super::trained::TrainedModels;
use crate::normal::StandardNormal;
use crate::proposed::ProposedPoints;
use crate::sobol::SobolSequence;
use crate::stream::stream;
use crate::{Grid, GridPoint};
use rand::RngExt;
use std::collections::{BTreeMap, BTreeSet};

/// Grids up to this size are searched completely, larger ones at a sample of candidates.
pub(super) const EXHAUSTIVE: u64 = 20_000;
/// Largest product of grid size and number of observations for a complete search (about ten milliseconds).
const EXHAUSTIVE_WORK: u64 = 1_000_000;
/// Number of candidates that are improved by local search.
const STARTS: usize = 4;
/// Cost of an acquisition with its gradient relative to one without.
const COST_OF_GRADIENT: usize = 3;
/// Largest number of gradient evaluations from one start.
const MAX_GRADIENTS: usize = 40;

/// Search region: the points not yet proposed.
#[derive(Clone, Copy)]
pub(super) struct SearchRegion<'a> {
    pub proposed: &'a ProposedPoints,
    /// Good points to start from, best first.
    pub incumbents: &'a [GridPoint],
}

/// Search for the unseen point with the largest acquisition; unseen points are those not yet proposed.
pub(super) struct Search<'a> {
    pub trained: &'a TrainedModels,
    pub region: SearchRegion<'a>,
}

/// Cache of computed acquisitions.
pub(super) type Acquisitions = BTreeMap<GridPoint, f64>;

impl Search<'_> {
    /// Returns the unseen grid point with the largest acquisition found; `None` if no unseen point was
    /// evaluated or none has a finite acquisition.
    pub fn maximise(&self) -> Option<GridPoint> {
        let size = self.region.grid().size();
        let known = (self.trained.len() * self.trained.models.len()) as u64;
        let small = size <= EXHAUSTIVE && size.saturating_mul(known) <= EXHAUSTIVE_WORK;
        if small { self.exhaustive() } else { self.sampled() }
    }

    /// Returns the best of all unseen points. The log expected improvement increases with the variance, so an
    /// upper bound of the variance bounds it, and constraints only lower it. Points are evaluated in the
    /// order of decreasing bound until it falls below the best value; few need the triangular solve.
    fn exhaustive(&self) -> Option<GridPoint> {
        let unseen =
            self.region.grid().points().filter(|point| !self.region.proposed.contains(point));
        let bound =
            |point: GridPoint| (self.trained.bound(&self.region.grid().free_unit(&point)), point);
        let mut bounds: Vec<(f64, GridPoint)> = unseen.map(bound).collect();
        // Equal bounds stay in lexicographic order: the sort is stable.
        bounds.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut best: Option<(f64, GridPoint)> = None;
        for (bound, point) in bounds {
            let largest = best.as_ref().map_or(f64::NEG_INFINITY, |b| b.0);
            if bound <= largest {
                break;
            }
            let value = self.trained.acquisition(&self.region.grid().free_unit(&point));
            if value > largest {
                best = Some((value, point));
            }
        }
        best.map(|(_, point)| point)
    }

    /// Returns the best point found from Sobol points and perturbations of the incumbents, of which the best
    /// are improved by L-BFGS within the cube and then by steps of one level on the grid.
    fn sampled(&self) -> Option<GridPoint> {
        let (n, models) = (self.trained.len(), self.trained.models.len());
        // A prediction takes about n^2 / 4 + 15 n nanoseconds; about six milliseconds in all.
        let budget = (6_000_000 / models / (n * n / 4 + 15 * n + 200)).clamp(300, 6000);
        let mut computed = Acquisitions::new();
        let candidates = self.region.candidates(budget / 3);
        let value = |point| (self.value(&point, &mut computed), point);
        let mut ranked: Vec<(f64, GridPoint)> = candidates.into_iter().map(value).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        ranked.truncate(STARTS);
        let share = (budget - budget / 3) / ranked.len().max(1);
        let axes = self.region.grid().free_axes().len();
        let evaluations = (share / 2 / COST_OF_GRADIENT).min(MAX_GRADIENTS);
        let limits = Limits { low: &vec![0.0; axes], high: &vec![1.0; axes], evaluations };
        for (_, point) in ranked {
            let top = self.ascend(&point, &limits);
            self.step_uphill(top, share / 2, &mut computed);
        }
        self.region.best_unseen(computed).map(|(point, _)| point)
    }

    /// Returns the grid point nearest to the result of L-BFGS within a box.
    pub fn ascend(&self, from: &GridPoint, limits: &Limits) -> GridPoint {
        let negated = |x: &[f64]| {
            let (value, gradient) = self.trained.acquisition_and_gradient(x)?;
            Some((-value, gradient.into_iter().map(|g| -g).collect()))
        };
        let grid = self.region.grid();
        let top = minimise(negated, &grid.free_unit(from), limits);
        top.map_or_else(|| from.clone(), |(top, _)| grid.folded(&top))
    }

    pub fn value(&self, point: &GridPoint, computed: &mut Acquisitions) -> f64 {
        let acquisition = || self.trained.acquisition(&self.region.grid().free_unit(point));
        *computed.entry(point.clone()).or_insert_with(acquisition)
    }

    /// Moves by one level along each axis as long as this improves the acquisition, with at most `budget` evaluations.
    /// Stores every evaluated point in `computed`.
    pub fn step_uphill(&self, mut at: GridPoint, mut budget: usize, computed: &mut Acquisitions) {
        let mut value = self.value(&at, computed);
        let free = self.region.grid().free_axes();
        let mut axes_left = free.len();
        for &axis in free.iter().cycle() {
            let levels = self.region.grid().levels()[axis];
            let beside = [at.0[axis].checked_add(1), at.0[axis].checked_sub(1)];
            let mut improved = false;
            for level in beside.into_iter().flatten().filter(|&k| k < levels) {
                if budget == 0 {
                    return;
                }
                budget -= 1;
                let mut next = at.clone();
                next.0[axis] = level;
                let there = self.value(&next, computed);
                if there > value {
                    (at, value, improved) = (next, there, true);
                    break;
                }
            }
            axes_left = if improved { free.len() } else { axes_left - 1 };
            if axes_left == 0 {
                return;
            }
        }
    }
}

impl SearchRegion<'_> {
    pub fn grid(&self) -> &Grid {
        &self.proposed.grid
    }

    /// Returns the unseen point with the largest finite value.
    pub fn best_unseen(&self, computed: Acquisitions) -> Option<(GridPoint, f64)> {
        let unseen = computed.into_iter().filter(|(p, _)| !self.proposed.contains(p));
        let finite = unseen.filter(|(_, v)| *v > f64::NEG_INFINITY);
        finite.reduce(|a, b| if b.1 > a.1 { b } else { a })
    }

    /// Returns Sobol points and perturbations of the incumbents, half of each, ascending.
    pub fn candidates(&self, count: usize) -> Vec<GridPoint> {
        let (grid, seed, call) = (self.grid(), self.proposed.seed, self.proposed.len());
        let half = count / 2;
        let sobol = SobolSequence::new(grid.dimension(), seed, call, "gp candidates");
        let mut points: BTreeSet<GridPoint> = sobol.take(half).map(|u| grid.cell(&u)).collect();
        let mut random = stream(seed, call, "gp perturbations");
        for i in 0..if self.incumbents.is_empty() { 0 } else { half } {
            let mut unit = grid.unit(&self.incumbents[i % self.incumbents.len()]);
            // Radii from 1/200 to 1/3 of the edge, on a logarithmic scale.
            let radius = libm::exp(-5.3 + 4.2 * random.random::<f64>());
            for u in &mut unit {
                *u += 0.7 * radius * random.sample::<f64, _>(StandardNormal);
            }
            points.insert(grid.snap(&unit));
        }
        points.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::hyperparameters::Hyperparameters;
    use super::super::model::Gp;
    use super::super::trained::Goal;
    use super::*;

    #[test]
    fn the_bounded_search_finds_what_trying_every_point_finds() {
        let x: Vec<Vec<f64>> = (0..40)
            .map(|i| vec![f64::from(i * 7 % 40) / 39.0, f64::from(i * 11 % 40) / 39.0])
            .collect();
        let y: Vec<f64> = x.iter().map(|p| libm::sin(7.0 * p[0]) * libm::cos(5.0 * p[1])).collect();
        let theta =
            Hyperparameters { log_length: vec![-1.2, -1.0], log_signal: 0.0, log_noise: -12.0 };
        let gp = Gp::new(&x, &y, 1e-6, &theta).unwrap();
        let mut proposed = ProposedPoints::new(Grid::new(vec![31, 1, 29]), 0);
        for k in 0..15 {
            proposed.insert(&GridPoint(vec![2 * k, 0, k]));
        }
        let best = y.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let trained =
            TrainedModels { models: vec![gp], zeros: Vec::new(), goal: Goal::Improve(best) };
        let proposed = &proposed;
        let region = SearchRegion { proposed, incumbents: &[] };
        let search = Search { trained: &trained, region };
        let found = search.exhaustive().unwrap();
        let mut computed = BTreeMap::new();
        let value = search.value(&found, &mut computed);
        assert!(!proposed.contains(&found));
        for point in proposed.grid.points() {
            let other = search.value(&point, &mut computed);
            assert!(proposed.contains(&point) || other <= value + 1e-9);
        }
        let sampled = search.sampled().unwrap();
        assert!(search.value(&sampled, &mut computed) > value - 1e-6);
    }
}
