//! Nelder-Mead on a grid, from the best known point.

use super::{Grid, GridPoint, Observation};
use crate::proposed::Costs;
use argmin::core::{CostFunction, Error, Executor};
use argmin::solver::neldermead;
use std::cell::RefCell;

/// Edge of the first simplex, in edges of the cube; each further run halves it.
const EDGE: f64 = 0.1;
/// Largest number of iterations of a run, far more than a simplex needs to collapse. With recorded values an
/// iteration takes microseconds.
const MAX_ITERATIONS: u64 = 1000;
/// Consecutive runs without a new point after which the search has converged.
const STALLED_RUNS: u32 = 3;

/// argmin's Nelder-Mead with an ask-and-tell interface. It minimises the negated merits.
///
/// - Each ask repeats the current run with the known values and proposes the first point without one. The rest
///   of the batch are points that the run needs next if that one turns out worse or better than all others.
/// - Points outside the cube are reflected at its faces; all are snapped to the nearest grid point.
/// - A run that needs no new value has converged. The next one starts at the best point with half
///   the edge, because a simplex can collapse before it reaches an optimum.
#[derive(Debug, Clone)]
pub(super) struct NelderMead {
    pub costs: Costs,
    /// Points whose results are pending.
    pending: Vec<GridPoint>,
    /// First simplex of the run: vertices on the free axes; empty if no observation has a value.
    simplex: Vec<Vec<f64>>,
    runs: i32,
    stalled_runs: u32,
}

impl NelderMead {
    /// Creates a search that starts at the best of the observations `told`.
    pub fn new(grid: Grid, told: &[Observation]) -> Self {
        let costs = Costs::new(grid, 0);
        let (pending, simplex) = (Vec::new(), Vec::new());
        let mut search = NelderMead { costs, pending, simplex, runs: 0, stalled_runs: 0 };
        search.tell(told);
        search.restart();
        search
    }

    /// Proposes up to `n` new points; none if the search has converged.
    pub fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        while n > 0 && self.simplex.len() > 1 && self.stalled_runs < STALLED_RUNS {
            let mut points = self.missing(n);
            points.retain(|point| self.costs.proposed.insert(point));
            if !points.is_empty() {
                self.stalled_runs = 0;
                self.pending.clone_from(&points);
                return points;
            }
            self.stalled_runs += 1;
            self.restart();
        }
        Vec::new()
    }

    /// Accepts the results of the points proposed last.
    pub fn tell(&mut self, observations: &[Observation]) {
        self.costs.tell(observations);
        // If a proposed point had no cost, every run would end there.
        for point in self.pending.drain(..) {
            self.costs.by_point.entry(point).or_insert(f64::INFINITY);
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

    /// Returns up to `n` points whose values the run needs, taken alternately from two runs: in one all unknown points
    /// have infinite cost, in the other minus infinite cost.
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

    /// Repeats the run with the cost `assumed` for points of unknown cost and returns these points: at least the
    /// first `n`, if the run evaluates that many.
    fn run(&self, assumed: f64, n: usize) -> Vec<GridPoint> {
        // An error at a vertex of the first simplex would panic in argmin.
        let most = n.max(self.simplex.len());
        let known = KnownCosts { costs: &self.costs, assumed, most, missing: RefCell::default() };
        let solver = neldermead::NelderMead::new(self.simplex.clone()).with_sd_tolerance(0.0);
        let Ok(solver) = solver else { return Vec::new() };
        let run = Executor::new(&known, solver).timer(false);
        // The run ends with an error once enough points are missing.
        let _ = run.configure(|state| state.max_iters(MAX_ITERATIONS)).run();
        known.missing.into_inner()
    }
}

/// Known costs, and the points of unknown cost that a run evaluated.
struct KnownCosts<'a> {
    costs: &'a Costs,
    assumed: f64,
    most: usize,
    missing: RefCell<Vec<GridPoint>>,
}

impl CostFunction for &KnownCosts<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Vec<f64>) -> Result<f64, Error> {
        let point = self.costs.proposed.grid.folded(x);
        if let Some(cost) = self.costs.by_point.get(&point) {
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
