//! Nelder-Mead about the best point told, on a grid.

use super::{Grid, GridPoint, Observation};
use crate::proposed::Costs;

/// Edge of the first simplex, in edges of the cube; each run begins with half of it.
const EDGE: f64 = 0.1;
/// Iterations in a row that need no new value after which a run has converged.
const BARREN_ITERATIONS: u32 = 12;
/// Runs in a row without a new point after which there is nothing more to propose.
const BARREN_RUNS: u32 = 3;

/// Nelder-Mead (Lagarias et al. 1998, SIAM J. Optim. 9:112) as a state machine: an iteration
/// goes as far as the values told allow and names the points it waits for. It minimises the
/// negated merits.
///
/// - Coordinates beyond a face of the cube are reflected, and snapped to the nearest level.
/// - Points told before are answered from memory. A run that needs nothing new has converged;
///   the next one begins at the best point with half the simplex, because a simplex can
///   collapse short of an optimum.
/// - A batch holds the point needed first and the other moves of the same simplex.
#[derive(Debug, Clone)]
pub(super) struct NelderMead {
    pub costs: Costs,
    /// Asked and not told.
    pending: Vec<GridPoint>,
    /// Vertices on the free axes; empty if nothing told has a value.
    simplex: Vec<Vec<f64>>,
    runs: i32,
    barren_iterations: u32,
    barren_runs: u32,
}

impl NelderMead {
    /// Starts at the best of what others have `told`.
    pub fn new(grid: Grid, told: &[Observation]) -> Self {
        let mut search = NelderMead {
            costs: Costs::new(grid, 0),
            pending: Vec::new(),
            simplex: Vec::new(),
            runs: 0,
            barren_iterations: 0,
            barren_runs: 0,
        };
        search.tell(told);
        search.restart();
        search
    }

    /// Up to `n` new points; none where it waits for values or has converged.
    pub fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        let mut points = self.wanted();
        // Two moves may end on one grid point.
        let mut left = n;
        points.retain(|point| {
            let new = left > 0 && self.costs.proposed.insert(point);
            left -= usize::from(new);
            new
        });
        if !points.is_empty() {
            (self.barren_iterations, self.barren_runs) = (0, 0);
        }
        self.pending.extend_from_slice(&points);
        points
    }

    /// The values of the points asked.
    pub fn tell(&mut self, observations: &[Observation]) {
        self.costs.tell(observations);
        // A run would wait for ever for what was asked and not told.
        for point in self.pending.drain(..) {
            self.costs.of.entry(point).or_insert(f64::INFINITY);
        }
    }

    /// Goes on until a value is missing; the points wanted then, the needed one first.
    fn wanted(&mut self) -> Vec<GridPoint> {
        while self.simplex.len() > 1 && self.barren_runs < BARREN_RUNS {
            if let Err(wanted) = self.iterate() {
                return wanted;
            }
            self.barren_iterations += 1;
            if self.barren_iterations > BARREN_ITERATIONS {
                self.barren_runs += 1;
                self.restart();
            }
        }
        Vec::new()
    }

    /// A simplex about the best point: its vertices lie along each free axis, on the side
    /// with more room, at least one level away.
    fn restart(&mut self) {
        self.barren_iterations = 0;
        let grid = self.costs.proposed.grid();
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

    /// One iteration, or the points whose values it needs.
    fn iterate(&mut self) -> Result<(), Vec<GridPoint>> {
        let point = |x: &Vec<f64>| self.costs.proposed.grid().folded(x);
        let value = |x: &Vec<f64>| self.costs.of.get(&point(x)).copied();
        let unknown: Vec<GridPoint> =
            self.simplex.iter().filter(|x| value(x).is_none()).map(point).collect();
        if !unknown.is_empty() {
            return Err(unknown);
        }
        let mut ranked: Vec<(f64, Vec<f64>)> =
            self.simplex.iter().filter_map(|x| Some((value(x)?, x.clone()))).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let last = ranked.len() - 1;
        let (best, second_worst, worst) = (ranked[0].0, ranked[last - 1].0, ranked[last].0);
        let centre = |i: usize| ranked[..last].iter().map(|(_, x)| x[i]).sum::<f64>() / last as f64;
        let towards = |factor: f64| -> Vec<f64> {
            let away = |i: usize| centre(i) + factor * (centre(i) - ranked[last].1[i]);
            (0..last).map(away).collect()
        };
        let [reflected, expanded, inside, outside] = [1.0, 2.0, -0.5, 0.5].map(towards);
        let known = |needed: &Vec<f64>| {
            let moves = [needed, &reflected, &expanded, &inside, &outside];
            let unknown = moves.into_iter().filter(|x| value(x).is_none());
            value(needed).ok_or_else(|| unknown.map(point).collect::<Vec<GridPoint>>())
        };
        let at = known(&reflected)?;
        let accepted = if at < best {
            Some(if known(&expanded)? < at { expanded } else { reflected })
        } else if at < second_worst {
            Some(reflected)
        } else if at < worst {
            (known(&outside)? <= at).then_some(outside)
        } else {
            (known(&inside)? < worst).then_some(inside)
        };
        let mut simplex: Vec<Vec<f64>> = ranked.into_iter().map(|(_, x)| x).collect();
        match accepted {
            Some(x) => simplex[last] = x,
            None => {
                let best = simplex[0].clone();
                for (x, best) in simplex[1..].iter_mut().flat_map(|x| x.iter_mut().zip(&best)) {
                    *x = 0.5 * (*x + best);
                }
            }
        }
        self.simplex = simplex;
        Ok(())
    }
}
