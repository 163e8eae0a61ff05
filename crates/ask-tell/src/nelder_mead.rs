//! Nelder-Mead about the best point told, on a grid.

use super::{Grid, GridPoint, Observation};
use crate::proposed::Costs;
use argmin::core::{CostFunction, Error, Executor};
use argmin::solver::neldermead;
use std::cell::RefCell;

/// Edge of the first simplex, in edges of the cube; each run begins with half of it.
const EDGE: f64 = 0.1;
/// Iterations of a run. On recorded values one takes microseconds; a simplex has long collapsed then.
const MAX_ITERATIONS: u64 = 1000;
/// Runs in a row without a new point after which there is nothing more to propose.
const BARREN_RUNS: u32 = 3;

/// Nelder-Mead of argmin by ask and tell. It minimises the negated merits.
///
/// - Each ask repeats the current run on the values told and proposes the first point without one. The
///   batch is filled with points that the run needs next, should that one fail or succeed.
/// - Coordinates beyond a face of the cube are reflected, and snapped to the nearest level.
/// - A run that needs no new value has converged. The next one begins at the best point with
///   half the simplex, because a simplex can collapse short of an optimum.
#[derive(Debug, Clone)]
pub(super) struct NelderMead {
    pub costs: Costs,
    /// Asked and not told.
    pending: Vec<GridPoint>,
    /// First simplex of the run: vertices on the free axes; empty if nothing told has a value.
    simplex: Vec<Vec<f64>>,
    runs: i32,
    barren_runs: u32,
}

impl NelderMead {
    /// Starts at the best of what others have `told`.
    pub fn new(grid: Grid, told: &[Observation]) -> Self {
        let costs = Costs::new(grid, 0);
        let (pending, simplex) = (Vec::new(), Vec::new());
        let mut search = NelderMead { costs, pending, simplex, runs: 0, barren_runs: 0 };
        search.tell(told);
        search.restart();
        search
    }

    /// Proposes up to `n` new points; none if the search has converged.
    pub fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        while n > 0 && self.simplex.len() > 1 && self.barren_runs < BARREN_RUNS {
            let mut points = self.missing(n);
            points.retain(|point| self.costs.proposed.insert(point));
            if !points.is_empty() {
                self.barren_runs = 0;
                self.pending.clone_from(&points);
                return points;
            }
            self.barren_runs += 1;
            self.restart();
        }
        Vec::new()
    }

    /// Takes in the values of the points asked.
    pub fn tell(&mut self, observations: &[Observation]) {
        self.costs.tell(observations);
        // A run would need for ever what was asked and not told.
        for point in self.pending.drain(..) {
            self.costs.of.entry(point).or_insert(f64::INFINITY);
        }
    }

    /// Builds a simplex about the best point: its vertices lie along each free axis, on the side
    /// with more room, at least one level away.
    fn restart(&mut self) {
        let grid = &self.costs.proposed.grid;
        let Some(start) = self.costs.best() else { return };
        let edge = EDGE * 0.5f64.powi(self.runs);
        self.simplex = vec![start.clone()];
        for (i, axis) in grid.free_axes().into_iter().enumerate() {
            let step = edge.max(1.0 / f64::from(grid.levels()[axis] - 1));
            let mut vertex = start.clone();
            vertex[i] += if start[i] > 0.5 { -step } else { step };
            self.simplex.push(vertex);
        }
        self.runs += 1;
    }

    /// Returns up to `n` points whose values the run needs: in turn those for a failure and those for a
    /// success of the points before.
    fn missing(&self, n: usize) -> Vec<GridPoint> {
        let [failure, success] = [f64::INFINITY, f64::NEG_INFINITY].map(|cost| self.run(cost, n));
        let longest = failure.len().max(success.len());
        let mut missing: Vec<GridPoint> = Vec::new();
        for point in (0..longest).flat_map(|i| [failure.get(i), success.get(i)]).flatten() {
            if missing.len() < n && !missing.contains(point) {
                missing.push(point.clone());
            }
        }
        missing
    }

    /// Repeats the run with this cost of points that have none, and returns at least the first `n` of them
    /// if there are so many.
    fn run(&self, assumed: f64, n: usize) -> Vec<GridPoint> {
        // argmin unwraps the costs of the first simplex.
        let most = n.max(self.simplex.len());
        let recorded = Recorded { costs: &self.costs, assumed, most, missing: RefCell::default() };
        let solver = neldermead::NelderMead::new(self.simplex.clone()).with_sd_tolerance(0.0);
        let Ok(solver) = solver else { return Vec::new() };
        let run = Executor::new(&recorded, solver).timer(false);
        // It ends by an error when enough points are missing.
        let _ = run.configure(|state| state.max_iters(MAX_ITERATIONS)).run();
        recorded.missing.into_inner()
    }
}

/// Costs of the points told, and the points that were needed beside them.
struct Recorded<'a> {
    costs: &'a Costs,
    assumed: f64,
    most: usize,
    missing: RefCell<Vec<GridPoint>>,
}

impl CostFunction for &Recorded<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Vec<f64>) -> Result<f64, Error> {
        let point = self.costs.proposed.grid.folded(x);
        if let Some(cost) = self.costs.of.get(&point) {
            return Ok(*cost);
        }
        let mut missing = self.missing.borrow_mut();
        if !missing.contains(&point) {
            if missing.len() >= self.most {
                return Err(Error::msg("enough points"));
            }
            missing.push(point);
        }
        Ok(self.assumed)
    }
}
