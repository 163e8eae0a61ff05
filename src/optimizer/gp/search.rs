//! Where on the grid the acquisition is largest.

use super::trained::Trained;
use crate::input::space::GridPoint;
use crate::optimizer::sobol::SobolSequence;
use crate::optimizer::{Grid, Proposed};
use crate::stream::stream;
use rand::RngExt;
use std::collections::BTreeMap;

/// Grids up to this size are searched completely.
const EXHAUSTIVE: u64 = 20_000;
/// ... as long as grid size times observations stays below this (some ten milliseconds).
const EXHAUSTIVE_WORK: u64 = 1_000_000;
/// Starts of the local search.
const STARTS: usize = 6;

/// One search for the best unseen point.
pub(super) struct Search<'a> {
    pub trained: &'a Trained,
    pub proposed: &'a Proposed,
    /// Axes with more than one level: the model's axes.
    pub free: &'a [usize],
    /// Good points to start from, best first.
    pub incumbents: &'a [GridPoint],
    /// Names the streams.
    pub seed: u64,
}

impl Search<'_> {
    /// The unseen grid point found with the largest promise; `None` if no unseen point was
    /// met or none has a finite one.
    pub fn maximise(&self) -> Option<GridPoint> {
        let (size, known) = (self.grid().size(), self.trained.len() * self.trained.models());
        if size <= EXHAUSTIVE && size.saturating_mul(known as u64) <= EXHAUSTIVE_WORK {
            return self.exhaustive();
        }
        self.sampled()
    }

    fn grid(&self) -> &Grid {
        self.proposed.grid()
    }

    /// The model's coordinates of a point.
    fn unit(&self, point: &GridPoint) -> Vec<f64> {
        let unit = self.grid().unit(point);
        self.free.iter().map(|&a| unit[a]).collect()
    }

    /// Every unseen point, exactly: log expected improvement grows with the variance, so a bound
    /// of the variance bounds it, and constraints only take away from it. Points are taken by falling bound until the bound is
    /// below the best found, and few need the triangular solve.
    fn exhaustive(&self) -> Option<GridPoint> {
        let mut k = Vec::new();
        let mut bounds: Vec<(f64, GridPoint)> = Vec::new();
        let mut point = GridPoint(vec![0; self.grid().dimension()]);
        loop {
            if !self.proposed.contains(&point) {
                bounds.push((self.trained.bound(&self.unit(&point), &mut k), point.clone()));
            }
            if !advance(&mut point, self.grid().levels()) {
                break;
            }
        }
        // Equal bounds stay in lexicographic order: the sort is stable.
        bounds.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut best: Option<(f64, GridPoint)> = None;
        for (bound, point) in bounds {
            let record = best.as_ref().map_or(f64::NEG_INFINITY, |b| b.0);
            if bound <= record {
                break;
            }
            let promise = self.trained.promise_above(record, &self.unit(&point), &mut k);
            if let Some(value) = promise.filter(|value| *value > record) {
                best = Some((value, point));
            }
        }
        best.map(|(_, point)| point)
    }

    /// Sobol points and perturbations of the incumbents, the best of them improved by a
    /// coordinate search on the lattice with halving steps.
    fn sampled(&self) -> Option<GridPoint> {
        let (n, models) = (self.trained.len(), self.trained.models().max(1));
        // A prediction takes about n^2 / 4 + 15 n nanoseconds; some six milliseconds in all.
        let mut budget = (6_000_000 / models / (n * n / 4 + 15 * n + 200)).clamp(300, 6000);
        let mut memory: BTreeMap<GridPoint, f64> = BTreeMap::new();
        let spread = budget / 3;
        let mut candidates = self.candidates(spread);
        let mut ranked: Vec<(f64, GridPoint)> = Vec::with_capacity(candidates.len());
        candidates.sort();
        candidates.dedup();
        for point in candidates {
            budget = budget.saturating_sub(1);
            ranked.push((self.value(&point, &mut memory), point));
        }
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        ranked.truncate(STARTS);
        let share = budget / ranked.len().max(1);
        for (value, point) in ranked {
            self.climb(point, value, share, &mut memory);
        }
        let unseen = memory.into_iter().filter(|(p, _)| !self.proposed.contains(p));
        let best = unseen.filter(|(_, v)| *v > f64::NEG_INFINITY);
        best.reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(point, _)| point)
    }

    fn candidates(&self, count: usize) -> Vec<GridPoint> {
        let (grid, call) = (self.grid(), self.proposed.len());
        let half = count / 2;
        let sobol = SobolSequence::new(grid.dimension(), self.seed, call, "gp candidates");
        let mut points: Vec<GridPoint> = sobol.take(half).map(|u| grid.cell(&u)).collect();
        let mut random = stream(self.seed, call, "gp perturbations");
        for i in 0..if self.incumbents.is_empty() { 0 } else { half } {
            let mut unit = grid.unit(&self.incumbents[i % self.incumbents.len()]);
            // Radii from a twohundredth of the edge to a third, on a logarithmic scale.
            let radius = libm::exp(-5.3 + 4.2 * random.random::<f64>());
            for u in &mut unit {
                *u += radius * (random.random::<f64>() + random.random::<f64>() - 1.0) * 1.7;
            }
            points.push(grid.snap(&unit));
        }
        points
    }

    fn value(&self, point: &GridPoint, memory: &mut BTreeMap<GridPoint, f64>) -> f64 {
        if let Some(&value) = memory.get(point) {
            return value;
        }
        let value = self.trained.promise(&self.unit(point));
        memory.insert(point.clone(), value);
        value
    }

    /// Coordinate search: steps along each axis, doubled along after a success, halved when no
    /// axis improves, down to single levels. Leaves every point it tried in `memory`.
    fn climb(
        &self,
        mut at: GridPoint,
        mut value: f64,
        mut budget: usize,
        memory: &mut BTreeMap<GridPoint, f64>,
    ) {
        let mut scale = 1.0 / 16.0;
        loop {
            let mut improved = false;
            for &axis in self.free {
                let levels = self.grid().levels()[axis];
                let step = ((f64::from(levels) * scale) as i64).max(1);
                for signed in [step, -step] {
                    let moved = (i64::from(at.0[axis]) + signed).clamp(0, i64::from(levels) - 1);
                    let mut next = at.clone();
                    next.0[axis] = moved as u32;
                    if next == at {
                        continue;
                    }
                    if budget == 0 {
                        return;
                    }
                    budget -= 1;
                    let there = self.value(&next, memory);
                    if there > value {
                        (at, value, improved) = (next, there, true);
                        break;
                    }
                }
            }
            if !improved {
                let finest =
                    self.free.iter().all(|&a| f64::from(self.grid().levels()[a]) * scale < 2.0);
                if finest {
                    return;
                }
                scale /= 2.0;
            }
        }
    }
}

/// The next point in lexicographic order; false, and the first point again, after the last.
fn advance(point: &mut GridPoint, levels: &[u32]) -> bool {
    for (k, &n) in point.0.iter_mut().zip(levels).rev() {
        if *k + 1 < n {
            *k += 1;
            return true;
        }
        *k = 0;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::super::kernel::Hyperparameters;
    use super::super::model::Gp;
    use super::super::trained::Goal;
    use super::*;

    #[test]
    fn the_bounded_search_finds_what_trying_every_point_finds() {
        let x: Vec<Vec<f64>> = (0..40)
            .map(|i| vec![f64::from(i * 7 % 40) / 39.0, f64::from(i * 11 % 40) / 39.0])
            .collect();
        let y: Vec<f64> = x.iter().map(|p| (7.0 * p[0]).sin() * (5.0 * p[1]).cos()).collect();
        let theta =
            Hyperparameters { log_length: vec![-1.2, -1.0], log_signal: 0.0, log_noise: -12.0 };
        let gp = Gp::new(&x, &y, 1e-6, theta).unwrap();
        let mut proposed = Proposed::new(Grid::new(vec![31, 1, 29]), 0);
        for k in 0..15 {
            proposed.insert(&GridPoint(vec![2 * k, 0, k]));
        }
        let best = y.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let free = [0, 2];
        let trained =
            Trained { objectives: vec![gp], margins: Vec::new(), goal: Goal::Improve(best) };
        let (proposed, free) = (&proposed, &free);
        let search = Search { trained: &trained, proposed, free, incumbents: &[], seed: 0 };
        let found = search.exhaustive().unwrap();
        let mut memory = BTreeMap::new();
        let value = search.value(&found, &mut memory);
        assert!(!proposed.contains(&found));
        let mut point = GridPoint(vec![0; 3]);
        while advance(&mut point, proposed.grid().levels()) {
            let other = search.value(&point, &mut memory);
            assert!(proposed.contains(&point) || other <= value + 1e-9);
        }
        let sampled = search.sampled().unwrap();
        assert!(search.value(&sampled, &mut memory) > value - 1e-6);
    }
}
