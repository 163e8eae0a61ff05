//! The optimizer around the model.

use super::search::Room;
use super::training::{Model, Training};
use crate::proposed::Proposed;
use crate::sobol::SobolSequence;
use crate::{Grid, GridPoint, Observation, Optimizer, StopReason};

/// Default least standard deviation of the noise, in objective units: that of a value rounded
/// to steps of 0.1, 0.1 / sqrt(12).
pub const DEFAULT_NOISE_FLOOR: f64 = 0.1 * 0.288_675_134_594_812_9;
/// Points, told and proposed, up to which the process is conditioned on all.
const WHOLE: usize = 250;

/// Bayesian optimization over a grid. **Maximises.**
///
/// - *First design*: a scrambled Sobol sequence, one point more than free axes, at least 3.
/// - *Then*: the unseen point with the largest log expected improvement over the best posterior
///   mean at an observed point.
/// - *Constraints*: the improvement over the best feasible point times the probability of
///   feasibility; that alone while no feasible point is known.
/// - *Several objectives* (not warped): the expected hypervolume improvement over the front of the
///   posterior means.
/// - *Beyond 250 points* processes of the nearest ones stand for the whole, and hyperparameters are
///   refitted, to 200 of the points, at each twentieth more: the cost then grows little.
/// - *Batches*, and points asked and not yet told: kriging believer.
/// - *No value* (`None`, NaN, infinite) is taught as the worst value seen so far.
/// - Where the model has nothing to say, the Sobol sequence goes on, and after it random points.
#[derive(Debug, Clone)]
pub(crate) struct GpOptimizer {
    proposed: Proposed,
    training: Training,
    seed: u64,
    /// Axes with more than one level.
    free: u64,
    design: SobolSequence,
    told: Vec<Observation>,
    /// Asked and not told.
    pending: Vec<GridPoint>,
    /// The models of all that was told, and good points to start a search from, best first;
    /// `None` when they have to be made anew.
    model: Option<(Model, Vec<GridPoint>)>,
}

impl GpOptimizer {
    /// `noise_floors`: least standard deviation of the noise of each objective, in its units;
    /// what is missing or not a positive number counts as zero.
    pub fn new(grid: Grid, seed: u64, noise_floors: &[f64]) -> Self {
        GpOptimizer {
            free: grid.free_axes().len() as u64,
            design: SobolSequence::new(grid.dimension(), seed, 0, "gp design"),
            proposed: Proposed::new(grid, seed),
            training: Training::new(noise_floors),
            seed,
            told: Vec::new(),
            pending: Vec::new(),
            model: None,
        }
    }

    fn unit(&self, point: &GridPoint) -> Vec<f64> {
        self.proposed.grid().free_unit(point)
    }

    /// Fits and conditions the models for an ask of `n` points, unless that was done for these
    /// data.
    fn train(&mut self, n: usize) -> Option<(Model, Vec<GridPoint>)> {
        let whole = self.told.len() + self.pending.len() + n <= WHOLE;
        let fits = |(model, _): &(Model, _)| matches!(model, Model::Whole(_)) == whole;
        if !self.model.as_ref().is_some_and(fits) {
            let x: Vec<Vec<f64>> = self.told.iter().map(|o| self.unit(&o.point)).collect();
            self.model = self.training.model(&self.told, x, whole);
        }
        self.model.clone()
    }
}

impl Optimizer for GpOptimizer {
    fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        let mut points: Vec<GridPoint> = Vec::new();
        let mut model: Option<(Model, Vec<GridPoint>)> = None;
        while points.len() < n && !self.proposed.exhausted() {
            let mut found = None;
            if self.proposed.len() >= (self.free + 1).max(3) && self.free > 0 {
                if model.is_none() {
                    model = self.train(n);
                    if let Some((model, _)) = &mut model {
                        for point in &self.pending {
                            model.believe(&self.unit(point));
                        }
                    }
                }
                let (proposed, seed) = (&self.proposed, self.seed);
                found = model.as_ref().and_then(|(model, incumbents)| {
                    model.suggest(Room { proposed, incumbents, seed })
                });
            }
            if found.is_none() {
                let grid = self.proposed.grid();
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
            if !self.proposed.grid().contains(&o.point) {
                continue;
            }
            self.proposed.insert(&o.point);
            self.pending.retain(|p| *p != o.point);
            self.told.push(o.clone());
            self.model = None;
        }
    }

    fn stop(&self) -> Option<StopReason> {
        self.proposed.stop()
    }
}
