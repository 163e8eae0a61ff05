//! Non-adaptive optimizers.

use super::{Grid, GridPoint, Observation, Optimizer, StopReason};
use crate::proposed::ProposedPoints;

/// Optimizer that proposes the points of a sequence, each once, and then the remaining grid points.
pub(crate) struct Sequence<I> {
    proposed: ProposedPoints,
    points: I,
}

impl<I: Iterator<Item = GridPoint>> Sequence<I> {
    /// Creates the optimizer; `seed` determines the order of the remaining points.
    pub fn new(grid: Grid, seed: u64, points: I) -> Self {
        Sequence { proposed: ProposedPoints::new(grid, seed), points }
    }

    fn next(&mut self) -> Option<GridPoint> {
        if self.proposed.exhausted() {
            return None;
        }
        let unseen = self.points.find(|point| self.proposed.insert(point));
        unseen.or_else(|| self.proposed.next_unseen())
    }
}

impl<I: Iterator<Item = GridPoint>> Optimizer for Sequence<I> {
    fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        (0..n).map_while(|_| self.next()).collect()
    }

    fn tell(&mut self, observations: &[Observation]) {
        for observation in observations {
            self.proposed.insert(&observation.point);
        }
    }

    fn stop(&self) -> Option<StopReason> {
        self.proposed.stop()
    }
}
