//! Optimizer with chosen points after the initial design.

use super::{GridPoint, Observation, Optimizer, StopReason};
use std::collections::{BTreeSet, VecDeque};

/// Optimizer that proposes chosen points after the initial design of another optimizer, which proposes all
/// further points and receives all results.
///
/// The other optimizer must accept observations of points that it has not proposed, and must not
/// propose them again.
pub struct SeededOptimizer {
    inner: Box<dyn Optimizer + Send>,
    /// Points of the initial design that `inner` has not proposed yet; the chosen points follow it.
    initial: usize,
    chosen: VecDeque<GridPoint>,
    /// Points proposed so far; `inner` may have proposed a chosen one.
    proposed: Vec<GridPoint>,
}

impl SeededOptimizer {
    /// Creates the optimizer from a new `inner` optimizer whose initial design has `initial` points; the chosen
    /// points must lie on its grid.
    pub fn new(
        inner: Box<dyn Optimizer + Send>,
        initial: usize,
        chosen: impl IntoIterator<Item = GridPoint>,
    ) -> Self {
        let mut seen = BTreeSet::new();
        let chosen = chosen.into_iter().filter(|point| seen.insert(point.clone())).collect();
        SeededOptimizer { inner, initial, chosen, proposed: Vec::new() }
    }
}

impl Optimizer for SeededOptimizer {
    fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        let own = if self.chosen.is_empty() { n } else { n.min(self.initial) };
        let mut points = if own > 0 { self.inner.ask(own) } else { Vec::new() };
        self.initial = self.initial.saturating_sub(points.len());
        if !self.chosen.is_empty() {
            self.proposed.extend(points.iter().cloned());
            self.chosen.retain(|point| !self.proposed.contains(point));
        }
        let more = self.chosen.len().min(n - points.len());
        points.extend(self.chosen.drain(..more));
        points
    }

    fn tell(&mut self, observations: &[Observation]) {
        self.inner.tell(observations);
    }

    fn stop(&self) -> Option<StopReason> {
        self.inner.stop()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, OptimizerKind, build};

    #[test]
    fn chosen_points_are_proposed_once_after_the_initial_design() {
        let grid = Grid::new(vec![5, 5]);
        let chosen = [[0, 0], [4, 4], [0, 0], [2, 3]].map(|levels| GridPoint(levels.to_vec()));
        let inner = build(OptimizerKind::Gp, grid, 1);
        let mut optimizer = SeededOptimizer::new(inner, 3, chosen.clone());
        let mut seen = Vec::new();
        loop {
            let points = optimizer.ask(2);
            if points.is_empty() {
                break;
            }
            let value = |p: &GridPoint| Some(f64::from(p.0[0]) - f64::from(p.0[1]));
            let told: Vec<_> =
                points.iter().map(|p| Observation::new(p.clone(), value(p))).collect();
            optimizer.tell(&told);
            seen.extend(points);
        }
        for point in &chosen {
            assert_eq!(seen.iter().filter(|p| *p == point).count(), 1, "{point:?}");
            assert!(seen[..7].contains(point), "{seen:?}");
        }
        assert_eq!(seen.len(), 25, "every point once");
        assert_eq!(optimizer.stop(), Some(StopReason::GridExhausted));
    }
}
