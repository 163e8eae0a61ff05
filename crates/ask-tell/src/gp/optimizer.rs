//! Bayesian optimizer.

use super::search::SearchRegion;
use super::training::{Model, Training};
use crate::proposed::ProposedPoints;
use crate::sobol::SobolSequence;
use crate::{Grid, GridPoint, Observation, Optimizer, StopReason};

/// Default lower bound of the standard deviation of the noise, in objective units: that of the rounding of a value
/// to steps of 0.1, 0.1 / sqrt(12).
pub const DEFAULT_NOISE_FLOOR: f64 = 0.1 * 0.288_675_134_594_812_9;
/// Largest number of observed and pending points up to which one global process is conditioned on all of them.
const MAX_GLOBAL_POINTS: usize = 250;

/// Bayesian optimization over a grid. **Maximises.**
///
/// - *Initial design*: a scrambled Sobol sequence, one more point than free axes, at least 3.
/// - *Then*: the unseen point with the largest log expected improvement over the best posterior
///   mean at an observed point.
/// - *Constraints*: expected improvement over the best feasible point times the probability of
///   feasibility; the probability alone while no feasible point is known.
/// - *Several objectives* (not warped): expected hypervolume improvement over the front of the
///   posterior means.
/// - *Beyond 250 points*: local processes of the nearest points replace the global one, and
///   hyperparameters are refitted to 200 of the points after every 5 % more, which limits the cost.
/// - *Batches* and pending points: kriging believer.
/// - *Missing values* (`None`, NaN, infinite) are replaced by the worst value so far.
/// - *Fallback* where the model gives no suggestion: the Sobol sequence, then random points.
#[derive(Debug, Clone)]
pub(crate) struct GpOptimizer {
    proposed: ProposedPoints,
    training: Training,
    /// Points of the initial design.
    design: SobolSequence,
    told: Vec<Observation>,
    /// Proposed points without a result so far.
    pending: Vec<GridPoint>,
    /// Models of all observations, and good starting points for the search, best first; `None` if
    /// they have to be rebuilt.
    model: Option<(Model, Vec<GridPoint>)>,
}

impl GpOptimizer {
    /// Creates the optimizer. `noise_floors` are the least standard deviations of the noise of each
    /// objective, in its units; missing or non-positive entries count as zero.
    pub fn new(grid: Grid, seed: u64, noise_floors: &[f64]) -> Self {
        GpOptimizer {
            design: SobolSequence::new(grid.dimension(), seed, 0, "gp design"),
            proposed: ProposedPoints::new(grid, seed),
            training: Training::new(noise_floors),
            told: Vec::new(),
            pending: Vec::new(),
            model: None,
        }
    }

    fn unit(&self, point: &GridPoint) -> Vec<f64> {
        self.proposed.grid.free_unit(point)
    }

    /// Returns the models for an ask of `n` points, fitted only if the data have changed and conditioned on the
    /// pending points.
    fn train(&mut self, n: usize) -> Option<(Model, Vec<GridPoint>)> {
        let global = self.told.len() + self.pending.len() + n <= MAX_GLOBAL_POINTS;
        let fits = |(model, _): &(Model, _)| matches!(model, Model::Global(_)) == global;
        if !self.model.as_ref().is_some_and(fits) {
            let x: Vec<Vec<f64>> = self.told.iter().map(|o| self.unit(&o.point)).collect();
            self.model = self.training.model(&self.told, x, global);
        }
        let (mut model, incumbents) = self.model.clone()?;
        for point in &self.pending {
            model.believe(&self.unit(point));
        }
        Some((model, incumbents))
    }
}

impl Optimizer for GpOptimizer {
    fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        let free = self.proposed.grid.free_axes().len() as u64;
        let mut points: Vec<GridPoint> = Vec::new();
        let mut model: Option<(Model, Vec<GridPoint>)> = None;
        while points.len() < n && !self.proposed.exhausted() {
            let mut found = None;
            if self.proposed.len() >= (free + 1).max(3) && free > 0 {
                model = model.or_else(|| self.train(n));
                if let Some((model, incumbents)) = &model {
                    found = model.suggest(SearchRegion { proposed: &self.proposed, incumbents });
                }
            }
            if found.is_none() {
                let grid = &self.proposed.grid;
                let mut cells = self.design.by_ref().map(|unit| grid.cell(&unit));
                found = cells.find(|point| !self.proposed.contains(point));
            }
            let found = found.filter(|point| self.proposed.insert(point));
            let Some(point) = found.or_else(|| self.proposed.next_unseen()) else { break };
            if let Some((model, _)) = &mut model {
                model.believe(&self.unit(&point));
            }
            self.pending.push(point.clone());
            points.push(point);
        }
        points
    }

    fn tell(&mut self, observations: &[Observation]) {
        for o in observations {
            if self.proposed.grid.contains(&o.point) {
                self.proposed.insert(&o.point);
                self.pending.retain(|p| *p != o.point);
                self.told.push(o.clone());
                self.model = None;
            }
        }
    }

    fn stop(&self) -> Option<StopReason> {
        self.proposed.stop()
    }
}
