//! Uniform random search without replacement.

use super::{Grid, Observation, Optimizer, Proposed, StopReason};
use crate::GridPoint;

/// Draws unseen grid points uniformly; once most are seen, walks what is left in order.
#[derive(Debug, Clone)]
pub struct RandomSearch {
    proposed: Proposed,
}

impl RandomSearch {
    /// A random search over `grid`.
    pub fn new(grid: Grid, seed: u64) -> Self {
        RandomSearch { proposed: Proposed::new(grid, seed) }
    }
}

impl Optimizer for RandomSearch {
    fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        (0..n).map_while(|_| self.proposed.next_unseen()).collect()
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
