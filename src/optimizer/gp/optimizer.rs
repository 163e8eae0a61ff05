//! The optimizer around the model.

use super::data::standardise;
use super::fit::{FitEffort, fit};
use super::kernel::Hyperparameters;
use super::model::Gp;
use super::search::Search;
use crate::optimizer::sobol::SobolSequence;
use crate::optimizer::{Grid, Observation, Optimizer, Proposed, StopReason};
use crate::space::GridPoint;

/// Default least standard deviation of the noise, in objective units: that of a value rounded
/// to steps of 0.1, 0.1 / sqrt(12).
pub const DEFAULT_NOISE_FLOOR: f64 = 0.1 * 0.288_675_134_594_812_9;
/// Points around which the acquisition is searched more closely.
const INCUMBENTS: usize = 4;

/// Bayesian optimization over a grid. **Maximises.**
///
/// - *First design*: `max(5, d + 1)` points of a scrambled Sobol sequence, `d` the number of axes
///   with more than one level.
/// - *Then*: the unseen point with the largest log expected improvement over the best posterior
///   mean at an observed point. Hyperparameters are refitted when new values were told.
/// - *Batches*, and points asked and not yet told: kriging believer.
/// - *No value* (`None`, NaN, infinite) is taught as the worst value seen so far.
/// - Whenever the model has nothing to say (no values, no finite acquisition), the
///   Sobol sequence goes on, and after it unseen points are drawn at random.
#[derive(Debug, Clone)]
pub struct GpOptimizer {
    proposed: Proposed,
    noise_floor: f64,
    seed: u64,
    free: Vec<usize>,
    design: SobolSequence,
    told: Vec<Observation>,
    /// Asked and not told.
    pending: Vec<GridPoint>,
    theta: Option<Hyperparameters>,
    /// The model of all that was told; `None` when it has to be made anew.
    model: Option<Trained>,
}

/// A model and what belongs to it.
#[derive(Debug, Clone)]
struct Trained {
    gp: Gp,
    best: f64,
    incumbents: Vec<GridPoint>,
}

impl GpOptimizer {
    /// With the default noise floor.
    pub fn new(grid: Grid, seed: u64) -> Self {
        Self::with_noise_floor(grid, seed, DEFAULT_NOISE_FLOOR)
    }

    /// `noise_floor`: least standard deviation of the noise, in objective units. What is not a
    /// positive number counts as zero.
    pub fn with_noise_floor(grid: Grid, seed: u64, noise_floor: f64) -> Self {
        let free: Vec<usize> = (0..grid.dimension()).filter(|&i| grid.levels()[i] > 1).collect();
        GpOptimizer {
            design: SobolSequence::new(grid.dimension(), seed, 0, "gp design"),
            proposed: Proposed::new(grid, seed),
            noise_floor: if noise_floor.is_finite() { noise_floor.max(0.0) } else { 0.0 },
            seed,
            free,
            told: Vec::new(),
            pending: Vec::new(),
            theta: None,
            model: None,
        }
    }

    /// The model of all that was told, `None` while there is none.
    pub fn model(&self) -> Option<&Gp> {
        self.model.as_ref().map(|trained| &trained.gp)
    }

    fn design_size(&self) -> u64 {
        (self.free.len() as u64 + 1).max(5)
    }

    fn unit(&self, point: &GridPoint) -> Vec<f64> {
        let unit = self.proposed.grid().unit(point);
        self.free.iter().map(|&a| unit[a]).collect()
    }

    /// Fits and conditions the model, unless that was done for these data.
    fn train(&mut self) -> Option<Trained> {
        if self.model.is_some() {
            return self.model.clone();
        }
        let values: Vec<Option<f64>> = self.told.iter().map(|o| o.value).collect();
        let data = standardise(&values, self.noise_floor)?.warped();
        let x: Vec<Vec<f64>> = self.told.iter().map(|o| self.unit(&o.point)).collect();
        let effort = FitEffort::for_observations(x.len());
        let theta = fit(&x, &data.values, data.noise_floor, self.theta.as_ref(), effort);
        self.theta = Some(theta.clone());
        let gp = Gp::new(&x, &data.values, data.noise_floor, theta)?;
        let mut means: Vec<(f64, usize)> =
            x.iter().enumerate().map(|(i, p)| (gp.predict(p).0, i)).collect();
        means.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = means.first()?.0;
        let incumbents =
            means.iter().take(INCUMBENTS).map(|&(_, i)| self.told[i].point.clone()).collect();
        self.model = Some(Trained { gp, best, incumbents });
        self.model.clone()
    }

    fn suggest(&self, trained: &Trained) -> Option<GridPoint> {
        let search = Search {
            gp: &trained.gp,
            proposed: &self.proposed,
            free: &self.free,
            best: trained.best,
            incumbents: &trained.incumbents,
            seed: self.seed,
        };
        search.maximise()
    }

    /// The next cell of the Sobol sequence, or any unseen point.
    fn fill(&mut self) -> Option<GridPoint> {
        for unit in self.design.by_ref() {
            let point = self.proposed.grid().cell(&unit);
            if !self.proposed.contains(&point) {
                return Some(point);
            }
            if self.proposed.exhausted() {
                return None;
            }
        }
        None
    }
}

impl Optimizer for GpOptimizer {
    fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        let mut points: Vec<GridPoint> = Vec::new();
        let mut trained: Option<Trained> = None;
        while points.len() < n && !self.proposed.exhausted() {
            let mut found = None;
            if self.proposed.len() >= self.design_size() && !self.free.is_empty() {
                if trained.is_none() {
                    trained = self.train();
                    if let Some(t) = &mut trained {
                        for point in &self.pending {
                            t.gp.believe(&self.unit(point));
                        }
                    }
                }
                found = trained.as_ref().and_then(|t| self.suggest(t));
            }
            let found = found.or_else(|| self.fill()).filter(|p| self.proposed.insert(p));
            let Some(point) = found.or_else(|| self.proposed.next_unseen()) else { break };
            if let Some(t) = &mut trained {
                t.gp.believe(&self.unit(&point));
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
