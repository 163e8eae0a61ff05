//! CMA-ES on a grid.

use super::core::{Solution, StartBox};
use super::restarts::Restarts;
use super::stop::Tolerances;
use crate::proposed::Costs;
use crate::{Grid, GridPoint, Observation, Optimizer, StopReason};

/// Initial step size in units of the cube's edge (the tutorial advises 0.3 of the range).
const SIGMA: f64 = 0.3;
/// Least standard deviation of an axis, in grid steps: one candidate in ten leaves the level
/// of the mean along that axis.
const MIN_STD_STEPS: f64 = 0.3;
/// Generations without a new point after which the run is restarted.
const STALLED_GENERATIONS: u32 = 8;
/// Restarts without a new point after which a point not yet proposed is drawn instead.
const STALLED_RESTARTS: u32 = 3;
/// Largest number of draws for a point of the batch beyond a full generation.
const EXTRA_DRAWS: u32 = 50;

/// BIPOP-CMA-ES over a grid. **Maximises**: it minimises the negated values.
///
/// - *Bounds*: the search space R^n is folded onto the unit cube by reflection at its faces
///   (`x -> |x - 2 round(x / 2)|`), so no candidate is infeasible and an optimum on a face
///   is an ordinary minimum of the folded function. Axes with one level are omitted.
/// - *Steps*: the folded candidate is snapped to the nearest grid point. A standard deviation
///   never falls below 0.3 steps of its axis.
/// - *Duplicates* get the known value. Eight generations without a new point end the run; after three
///   such runs one unseen point is proposed instead.
/// - *Missing values* (`None`, NaN, infinite) rank behind every value.
/// - *Batches* that end within a generation enlarge it: the distribution is updated with all its
///   candidates and the strategy parameters for the actual size.
#[derive(Debug, Clone)]
pub(crate) struct CmaEsOptimizer {
    costs: Costs,
    restarts: Restarts,
    /// Candidates and the grid points they snap to.
    generation: Vec<(Vec<f64>, GridPoint)>,
    /// Whether the current generation proposed a new point.
    has_new_point: bool,
    stalled_generations: u32,
    stalled_restarts: u32,
}

impl CmaEsOptimizer {
    pub fn new(grid: Grid, seed: u64) -> Self {
        let free = grid.free_axes();
        let step = |&i: &usize| MIN_STD_STEPS / f64::from(grid.levels()[i] - 1);
        let start = StartBox {
            low: vec![0.0; free.len()],
            high: vec![1.0; free.len()],
            sigma: SIGMA,
            min_std: free.iter().map(step).collect(),
            max_lambda: (grid.size() / 10).clamp(8, 512) as usize,
            // On a grid equal values are common and do not indicate convergence.
            tolerances: Tolerances { fun: 0.0, fun_hist: 0.0, x: 0.0, x_up: 1e2 },
        };
        CmaEsOptimizer {
            restarts: Restarts::new(start, seed),
            costs: Costs::new(grid, seed),
            generation: Vec::new(),
            has_new_point: false,
            stalled_generations: 0,
            stalled_restarts: 0,
        }
    }

    /// Returns the next unseen candidate, or `None` after too many draws or barren restarts.
    fn next(&mut self) -> Option<GridPoint> {
        let mut extra = 0;
        while self.stalled_restarts < STALLED_RESTARTS && extra < EXTRA_DRAWS {
            let full = self.generation.len() >= self.restarts.current.lambda;
            if full
                && self.generation.iter().all(|(_, point)| self.costs.by_point.contains_key(point))
            {
                self.finish_generation();
                continue;
            }
            let x = self.restarts.current.sample();
            let point = self.costs.proposed.grid.folded(&x);
            let new = self.costs.proposed.insert(&point);
            // A full generation that is waiting for values is only extended by new points.
            if new || !full {
                self.generation.push((x, point.clone()));
            }
            if new {
                self.has_new_point = true;
                return Some(point);
            }
            extra += u32::from(full);
        }
        None
    }

    fn finish_generation(&mut self) {
        let solution = |(x, point)| Solution { x, value: self.costs.by_point[&point] };
        let told: Vec<Solution> =
            std::mem::take(&mut self.generation).into_iter().map(solution).collect();
        self.restarts.tell(&told);
        if std::mem::take(&mut self.has_new_point) {
            self.stalled_generations = 0;
            self.stalled_restarts = 0;
            return;
        }
        self.stalled_generations += 1;
        if self.stalled_generations >= STALLED_GENERATIONS {
            self.stalled_generations = 0;
            self.stalled_restarts += 1;
            self.restarts.restart();
        }
    }
}

impl Optimizer for CmaEsOptimizer {
    fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        let mut points = Vec::new();
        while points.len() < n && !self.costs.proposed.exhausted() {
            let found = if self.restarts.current.mean.is_empty() { None } else { self.next() };
            let Some(point) = found.or_else(|| self.costs.proposed.next_unseen()) else { break };
            self.stalled_restarts = 0;
            points.push(point);
        }
        points
    }

    fn tell(&mut self, observations: &[Observation]) {
        self.costs.tell(observations);
        // Results from before the first proposal: the run starts at the best of them.
        if self.generation.is_empty()
            && self.restarts.current.generation == 0
            && let Some(best) = self.costs.best()
        {
            self.restarts.current.mean = best.into();
        }
        // A candidate that never gets a value would block its generation.
        self.generation.retain(|(_, point)| self.costs.by_point.contains_key(point));
    }

    fn stop(&self) -> Option<StopReason> {
        self.costs.proposed.stop()
    }
}
