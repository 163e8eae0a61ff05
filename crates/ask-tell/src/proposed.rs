//! Points that an optimizer has already proposed, and access to the remaining ones.

use super::{Grid, GridPoint, Observation, StopReason};
use crate::stream::stream;
use rand::RngExt;
use std::collections::{BTreeMap, BTreeSet};

/// Number of random draws before the grid is enumerated in order.
const DRAWS: usize = 64;

/// Set of proposed points, to prevent duplicates.
#[derive(Debug, Clone)]
pub(crate) struct ProposedPoints {
    pub grid: Grid,
    pub seed: u64,
    points: BTreeSet<GridPoint>,
    /// Every point before this one in lexicographic order is in `points`.
    cursor: Option<GridPoint>,
}

impl ProposedPoints {
    /// Creates an empty set; `seed` is the seed of its optimizer's random streams.
    pub fn new(grid: Grid, seed: u64) -> Self {
        let cursor = grid.points().next();
        ProposedPoints { grid, seed, points: BTreeSet::new(), cursor }
    }

    pub fn len(&self) -> u64 {
        self.points.len() as u64
    }

    pub fn contains(&self, point: &GridPoint) -> bool {
        self.points.contains(point)
    }

    /// Marks `point` as proposed; returns false if it already was or is not on the grid.
    pub fn insert(&mut self, point: &GridPoint) -> bool {
        self.grid.contains(point) && self.points.insert(point.clone())
    }

    /// Returns whether every grid point has been proposed.
    pub fn exhausted(&self) -> bool {
        self.len() >= self.grid.size()
    }

    pub fn stop(&self) -> Option<StopReason> {
        self.exhausted().then_some(StopReason::GridExhausted)
    }

    /// Marks and returns a point not yet proposed: a uniformly drawn one or, if 64 draws find none,
    /// the first in lexicographic order. `None` if there is none.
    pub fn next_unseen(&mut self) -> Option<GridPoint> {
        if self.exhausted() {
            return None;
        }
        let mut random = stream(self.seed, self.len(), "unseen grid point");
        for _ in 0..DRAWS {
            let point =
                GridPoint(self.grid.levels().iter().map(|&n| random.random_range(0..n)).collect());
            if self.points.insert(point.clone()) {
                return Some(point);
            }
        }
        while let Some(point) = self.cursor.take() {
            self.cursor = self.grid.after(&point);
            if self.points.insert(point.clone()) {
                return Some(point);
            }
        }
        None
    }
}

/// Proposed points, and the costs (negated merits) of the observed ones; infinite for those without a merit.
#[derive(Debug, Clone)]
pub(crate) struct Costs {
    pub proposed: ProposedPoints,
    pub by_point: BTreeMap<GridPoint, f64>,
}

impl Costs {
    pub fn new(grid: Grid, seed: u64) -> Self {
        Costs { proposed: ProposedPoints::new(grid, seed), by_point: BTreeMap::new() }
    }

    pub fn tell(&mut self, observations: &[Observation]) {
        for o in observations {
            if self.proposed.grid.contains(&o.point) {
                let cost = o.merit().filter(|v| v.is_finite()).map_or(f64::INFINITY, |v| -v);
                self.proposed.insert(&o.point);
                self.by_point.insert(o.point.clone(), cost);
            }
        }
    }

    /// Returns the coordinates, on the free axes, of the point with the least finite cost.
    pub fn best(&self) -> Option<Vec<f64>> {
        let finite = self.by_point.iter().filter(|(_, cost)| cost.is_finite());
        let (best, _) = finite.min_by(|a, b| a.1.total_cmp(b.1))?;
        Some(self.proposed.grid.free_unit(best))
    }
}
