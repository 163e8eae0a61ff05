//! Local polish of the best point that another optimizer has found.

use super::nelder_mead::NelderMead;
use super::{Grid, GridPoint, Observation, Optimizer, StopReason};

/// Optimizer that takes its first points from another optimizer and then polishes the best of them by Nelder-Mead; the
/// number of points of each phase is limited.
///
/// It may propose fewer points than requested: at the end of the search, and in the polish, which only
/// proposes the points that Nelder-Mead needs.
pub struct Polished {
    inner: Box<dyn Optimizer + Send>,
    grid: Grid,
    /// Remaining points of the search by `inner`.
    search_left: u64,
    /// Remaining points of the polish.
    polish_left: u64,
    told: Vec<Observation>,
    polish: Option<NelderMead>,
    converged: bool,
}

impl Polished {
    /// Creates the optimizer; `inner` must be new and use the same grid. `search` and `polish` are the largest numbers
    /// of points of the two phases.
    pub fn new(inner: Box<dyn Optimizer + Send>, grid: Grid, search: u64, polish: u64) -> Self {
        Polished {
            inner,
            grid,
            search_left: search,
            polish_left: polish,
            told: Vec::new(),
            polish: None,
            converged: false,
        }
    }
}

impl Optimizer for Polished {
    fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        let n = n as u64;
        if self.search_left > 0 {
            let points = self.inner.ask(n.min(self.search_left) as usize);
            if !points.is_empty() {
                self.search_left -= points.len() as u64;
                return points;
            }
            self.search_left = 0;
        }
        let (grid, told) = (&self.grid, &self.told);
        let polish = self.polish.get_or_insert_with(|| NelderMead::new(grid.clone(), told));
        let points = polish.ask(n.min(self.polish_left) as usize);
        self.polish_left -= points.len() as u64;
        self.converged = points.is_empty();
        points
    }

    fn tell(&mut self, observations: &[Observation]) {
        if let Some(polish) = &mut self.polish {
            return polish.tell(observations);
        }
        self.inner.tell(observations);
        self.told.extend_from_slice(observations);
    }

    fn stop(&self) -> Option<StopReason> {
        let of_polish = self.polish.as_ref().map(|polish| polish.costs.proposed.stop());
        let exhausted = of_polish.unwrap_or_else(|| self.inner.stop());
        exhausted.or(self.converged.then_some(StopReason::Converged))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{OptimizerKind, build};
    use std::collections::BTreeSet;

    /// Returns the height of a narrow curved ridge with its top at 0.6 on the first and 0.36 on the last axis.
    fn ridge(grid: &Grid, point: &GridPoint) -> f64 {
        let u = grid.unit(point);
        -(0.6 - u[0]).powi(2) - 10.0 * (u[2] - u[0] * u[0]).powi(2)
    }

    fn grid() -> Grid {
        Grid::new(vec![201, 1, 201])
    }

    /// Returns all observations in order, and the stop reason.
    fn run(
        kind: OptimizerKind,
        search: u64,
        polish: u64,
        n: usize,
    ) -> (Vec<Observation>, Option<StopReason>) {
        let mut optimizer = Polished::new(build(kind, grid(), 5), grid(), search, polish);
        let mut all = Vec::new();
        loop {
            let points = optimizer.ask(n);
            if points.is_empty() {
                return (all, optimizer.stop());
            }
            let tell = |p: &GridPoint| Observation::new(p.clone(), Some(ridge(&grid(), p)));
            let told: Vec<Observation> = points.iter().map(tell).collect();
            optimizer.tell(&told);
            all.extend(told);
        }
    }

    fn best(of: &[Observation]) -> f64 {
        of.iter().filter_map(Observation::value).fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn the_polish_leaves_the_search_unchanged_and_improves_its_best_point() {
        for n in [1, 4] {
            let alone = build(OptimizerKind::Sobol, grid(), 5).ask(22);
            let (all, _) = run(OptimizerKind::Sobol, 22, 60, n);
            assert!(all.iter().zip(&alone).all(|(a, b)| a.point == *b));
            assert!(all.len() > 30 && all.len() <= 82, "{} points", all.len());
            let points: BTreeSet<&GridPoint> = all.iter().map(|o| &o.point).collect();
            assert_eq!(points.len(), all.len(), "a point twice");
            let (found, polished) = (best(&all[..22]), best(&all));
            assert!(polished > found / 4.0, "batches of {n}: {found} to {polished}");
        }
    }

    #[test]
    fn the_polish_stays_within_its_budget_and_ends_when_it_has_converged() {
        assert_eq!(run(OptimizerKind::Random, 10, 5, 4).0.len(), 15);
        assert_eq!(run(OptimizerKind::Random, 10, 0, 4).0.len(), 10);
        let (all, stop) = run(OptimizerKind::Random, 10, 100_000, 4);
        assert_eq!(stop, Some(StopReason::Converged));
        assert!(all.len() < 300, "{} points", all.len());
    }

    #[test]
    fn without_any_value_there_is_nothing_to_polish() {
        let mut none = Polished::new(build(OptimizerKind::Random, grid(), 5), grid(), 4, 20);
        let points = none.ask(4);
        let told: Vec<_> = points.into_iter().map(|point| Observation::new(point, None)).collect();
        none.tell(&told);
        assert!(none.ask(4).is_empty());
        assert_eq!(none.stop(), Some(StopReason::Converged));
    }
}
