//! Nelder-Mead with restarts, on a grid.

use super::cmaes::fold;
use super::simplex::{Simplex, Want};
use super::sobol::SobolSequence;
use super::{Grid, Observation, Optimizer, Proposed, StopReason};
use crate::input::space::GridPoint;
use std::collections::BTreeMap;

/// Edge of a first simplex at a new place, in edges of the cube.
const WIDE: f64 = 0.25;
/// Edge of a first simplex at the best point.
const NARROW: f64 = 0.1;
/// Iterations in a row that need no new value after which a run has converged.
const BARREN_ITERATIONS: u32 = 12;
/// Restarts without a new point after which an unseen point is taken instead.
const BARREN_RESTARTS: u32 = 3;
/// Iterations looked ahead for one place of a batch.
const LOOK_AHEAD: u32 = 12;

/// Nelder-Mead over a grid by argmin's solver. **Maximises**: it minimises the negated values.
///
/// - *Bounds and steps* as in CMA-ES: R^n is folded onto the unit cube by reflection at its faces
///   and snapped to the nearest grid point; axes with one level are left out.
/// - *Restarts*: a run whose iterations bring nothing new has converged. Every other run begins at
///   the best point so far with a new, narrow simplex, because a simplex can collapse short of
///   an optimum; the others begin at the points of a scrambled Sobol sequence.
/// - *Duplicates* are answered from memory; three runs that bring nothing new make way for one
///   unseen point.
/// - *No value* (`None`, NaN, infinite) is worse than every value.
/// - *Batches*: Nelder-Mead wants one value at a time. The further places of a batch are what
///   it would want next if the values it waits for were, in turn, bad (contraction, then the
///   points of a shrunk simplex) and good (expansion); where that brings no new point, unseen points.
#[derive(Clone)]
pub struct NelderMeadOptimizer {
    proposed: Proposed,
    /// Axes with more than one level.
    free: Vec<usize>,
    /// Negated values; infinite for points without one.
    values: BTreeMap<GridPoint, f64>,
    /// Asked and not told.
    pending: Vec<GridPoint>,
    /// Where further runs begin; `None` in a polish, which keeps to the best point.
    starts: Option<SobolSequence>,
    run: Simplex,
    runs: u64,
    barren_iterations: u32,
    barren_restarts: u32,
}

impl NelderMeadOptimizer {
    /// Nelder-Mead over `grid`; `seed` chooses where the runs begin.
    pub fn new(grid: Grid, seed: u64) -> Self {
        let mut optimizer = Self::bare(grid, seed);
        let axes = optimizer.free.len();
        optimizer.starts = Some(SobolSequence::new(axes, seed, 0, "nelder-mead start"));
        optimizer.restart();
        optimizer
    }

    /// A polish of what others have `told`: runs begin at the best point only, each with half
    /// the simplex of the one before. It proposes nothing but what Nelder-Mead wants, so fewer
    /// points than it is asked for, and none once its runs bring nothing new.
    pub fn polish(grid: Grid, told: &[Observation]) -> Self {
        let mut optimizer = Self::bare(grid, 0);
        optimizer.tell(told);
        optimizer.restart();
        optimizer
    }

    /// No run begun.
    fn bare(grid: Grid, seed: u64) -> Self {
        NelderMeadOptimizer {
            free: (0..grid.dimension()).filter(|&i| grid.levels()[i] > 1).collect(),
            starts: None,
            run: Simplex::new(Vec::new()),
            proposed: Proposed::new(grid, seed),
            values: BTreeMap::new(),
            pending: Vec::new(),
            runs: 0,
            barren_iterations: 0,
            barren_restarts: 0,
        }
    }

    fn restart(&mut self) {
        self.barren_iterations = 0;
        let best = self.best();
        let Some((start, edge)) = (match &mut self.starts {
            None => best.map(|best| (best, NARROW * 0.5f64.powi(self.runs as i32))),
            Some(starts) => match best.filter(|_| self.runs % 2 == 1) {
                Some(best) => Some((best, NARROW)),
                None => Some((starts.next().unwrap_or(vec![0.5; self.free.len()]), WIDE)),
            },
        }) else {
            return;
        };
        self.runs += 1;
        self.run = Simplex::new(self.vertices(&start, edge));
    }

    /// The best point with a value, on the free axes.
    fn best(&self) -> Option<Vec<f64>> {
        let finite = self.values.iter().filter(|(_, value)| value.is_finite());
        let (point, _) = finite.min_by(|a, b| a.1.total_cmp(b.1))?;
        let unit = self.proposed.grid().unit(point);
        Some(self.free.iter().map(|&axis| unit[axis]).collect())
    }

    /// A point and its neighbours along each axis, on the side with more room, at least
    /// one grid step away.
    fn vertices(&self, start: &[f64], edge: f64) -> Vec<Vec<f64>> {
        let mut vertices = vec![start.to_vec()];
        for (i, &axis) in self.free.iter().enumerate() {
            let step = 1.0 / f64::from(self.proposed.grid().levels()[axis] - 1);
            let mut vertex = start.to_vec();
            vertex[i] += if start[i] > 0.5 { -edge.max(step) } else { edge.max(step) };
            vertices.push(vertex);
        }
        vertices
    }

    /// The grid point of a point of the search space.
    fn point(&self, x: &[f64]) -> GridPoint {
        let mut unit = vec![0.5; self.proposed.grid().dimension()];
        for (&axis, &x) in self.free.iter().zip(x) {
            unit[axis] = fold(x);
        }
        self.proposed.grid().snap(&unit)
    }

    /// The first unseen point among those wanted.
    fn unseen(&self, wanted: &[Vec<f64>]) -> Option<GridPoint> {
        let mut points = wanted.iter().map(|x| self.point(x));
        points.find(|point| !self.proposed.contains(point))
    }

    /// Goes on as far as the known values allow; the unseen point wanted then, `None` if there
    /// is none or it waits for values.
    fn wanted(&mut self) -> Option<GridPoint> {
        while self.barren_restarts < BARREN_RESTARTS {
            let mut run = self.run.clone();
            let want = run.advance(&|x| self.values.get(&self.point(x)).copied());
            match want {
                Want::Start(wanted) => return self.unseen(&wanted),
                Want::Value(wanted) => return self.unseen(&[wanted]),
                Want::Iterated if self.barren_iterations < BARREN_ITERATIONS => {
                    self.barren_iterations += 1;
                    self.run = run;
                }
                Want::Iterated | Want::Broken => {
                    self.barren_restarts += 1;
                    self.restart();
                }
            }
        }
        None
    }

    /// The unseen point wanted next if every pending point had the value `guess`.
    fn guessed(&self, guess: f64) -> Option<GridPoint> {
        let value = |x: &[f64]| {
            let point = self.point(x);
            let known = self.values.get(&point).copied();
            known.or_else(|| self.pending.contains(&point).then_some(guess))
        };
        let mut run = self.run.clone();
        for _ in 0..LOOK_AHEAD {
            match run.advance(&value) {
                Want::Start(wanted) => return self.unseen(&wanted),
                Want::Value(wanted) => return self.unseen(&[wanted]),
                Want::Iterated => {}
                Want::Broken => return None,
            }
        }
        None
    }

    fn next(&mut self) -> Option<GridPoint> {
        if self.free.is_empty() {
            return self.proposed.next_unseen();
        }
        if self.runs == 0 {
            // A polish of nothing.
            return None;
        }
        let guesses = match self.pending.len() % 2 {
            0 => [f64::NEG_INFINITY, f64::INFINITY],
            _ => [f64::INFINITY, f64::NEG_INFINITY],
        };
        let found = self.wanted();
        let found = found.or_else(|| guesses.into_iter().find_map(|guess| self.guessed(guess)));
        match found {
            Some(point) => {
                self.barren_iterations = 0;
                self.proposed.insert(&point).then_some(point)
            }
            None if self.starts.is_none() => None,
            None => self.proposed.next_unseen(),
        }
    }
}

impl Optimizer for NelderMeadOptimizer {
    fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        let mut points = Vec::new();
        while points.len() < n && !self.proposed.exhausted() {
            let Some(point) = self.next() else { break };
            self.barren_restarts = 0;
            self.pending.push(point.clone());
            points.push(point);
        }
        points
    }

    fn tell(&mut self, observations: &[Observation]) {
        for o in observations {
            if !self.proposed.grid().contains(&o.point) {
                continue;
            }
            let value = o.merit().filter(|v| v.is_finite()).map_or(f64::INFINITY, |v| -v);
            self.proposed.insert(&o.point);
            self.values.insert(o.point.clone(), value);
        }
        // A run would wait for ever for what was asked and not told.
        for point in self.pending.drain(..) {
            self.values.entry(point).or_insert(f64::INFINITY);
        }
    }

    fn stop(&self) -> Option<StopReason> {
        self.proposed.stop()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Best of `evaluations` values of a curved valley, asked in batches of `n`.
    fn valley(evaluations: usize, n: usize) -> f64 {
        let grid = Grid::new(vec![1001, 1, 1001]);
        let mut optimizer = NelderMeadOptimizer::new(grid.clone(), 3);
        let value = |point: &GridPoint| {
            let u = grid.unit(point);
            let (x, y) = (4.0 * u[0] - 2.0, 4.0 * u[2] - 2.0);
            -(1.0 - x).powi(2) - 10.0 * (y - x * x).powi(2)
        };
        let mut best = f64::NEG_INFINITY;
        for _ in 0..evaluations / n {
            let tell = |p: GridPoint| {
                let value = value(&p);
                Observation::new(p, Some(value))
            };
            let told: Vec<Observation> = optimizer.ask(n).into_iter().map(tell).collect();
            best = told.iter().filter_map(Observation::value).fold(best, f64::max);
            optimizer.tell(&told);
        }
        best
    }

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        for n in [1, 3, 4] {
            let best = valley(240, n);
            assert!(best > -1e-3, "batches of {n}: {best}");
        }
    }
}
