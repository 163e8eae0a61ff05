//! The optimizer around the model.

use super::data::{Standardised, standardise};
use super::fit::{FitEffort, fit};
use super::kernel::Hyperparameters;
use super::model::Gp;
use super::search::Search;
use super::trained::{Front, Goal, Margin, Trained};
use crate::evaluation::pareto::front;
use crate::input::space::GridPoint;
use crate::optimizer::sobol::SobolSequence;
use crate::optimizer::{Grid, Observation, Optimizer, Proposed, StopReason};

/// Default least standard deviation of the noise, in objective units: that of a value rounded
/// to steps of 0.1, 0.1 / sqrt(12).
pub const DEFAULT_NOISE_FLOOR: f64 = 0.1 * 0.288_675_134_594_812_9;
/// Points around which the acquisition is searched more closely.
const INCUMBENTS: usize = 4;

/// Bayesian optimization over a grid. **Maximises.**
///
/// - *First design*: `d + 1` points of a scrambled Sobol sequence, at least 3, `d` the number of
///   axes with more than one level.
/// - *Then*: the unseen point with the largest log expected improvement over the best posterior
///   mean at an observed point. Hyperparameters are refitted when new values were told.
/// - *Constraints*: each has a model of its own. What is maximised is the improvement over the
///   best feasible point times the probability of feasibility; that probability alone while no
///   feasible point is known.
/// - *Several objectives*: each has a model of its own (not warped); what is maximised is the
///   expected hypervolume improvement over the front of the posterior means.
/// - *Batches*, and points asked and not yet told: kriging believer.
/// - *No value* (`None`, NaN, infinite) is taught as the worst value seen so far.
/// - Whenever the model has nothing to say (no values, no finite acquisition), the
///   Sobol sequence goes on, and after it unseen points are drawn at random.
#[derive(Debug, Clone)]
pub struct GpOptimizer {
    proposed: Proposed,
    /// Least standard deviation of the noise of each objective; 0 for those beyond the last.
    noise_floors: Vec<f64>,
    seed: u64,
    free: Vec<usize>,
    design: SobolSequence,
    told: Vec<Observation>,
    /// Asked and not told.
    pending: Vec<GridPoint>,
    /// Hyperparameters of the last fit, objectives first, then constraints.
    thetas: Vec<Hyperparameters>,
    /// The models of all that was told, and good points to start a search from, best first;
    /// `None` when they have to be made anew.
    model: Option<(Trained, Vec<GridPoint>)>,
}

impl GpOptimizer {
    /// With the default noise floor.
    pub fn new(grid: Grid, seed: u64) -> Self {
        Self::with_noise_floors(grid, seed, &[DEFAULT_NOISE_FLOOR])
    }

    /// `noise_floors`: least standard deviation of the noise of each objective, in its units;
    /// what is missing or not a positive number counts as zero.
    pub fn with_noise_floors(grid: Grid, seed: u64, noise_floors: &[f64]) -> Self {
        let floor = |&floor: &f64| if floor.is_finite() { floor.max(0.0) } else { 0.0 };
        let free = grid.free_axes();
        GpOptimizer {
            design: SobolSequence::new(grid.dimension(), seed, 0, "gp design"),
            proposed: Proposed::new(grid, seed),
            noise_floors: noise_floors.iter().map(floor).collect(),
            seed,
            free,
            told: Vec::new(),
            pending: Vec::new(),
            thetas: Vec::new(),
            model: None,
        }
    }

    /// The model of the first objective of all that was told, `None` while there is none.
    pub fn model(&self) -> Option<&Gp> {
        self.model.as_ref().and_then(|(trained, _)| trained.objectives.first())
    }

    fn design_size(&self) -> u64 {
        (self.free.len() as u64 + 1).max(3)
    }

    fn unit(&self, point: &GridPoint) -> Vec<f64> {
        let unit = self.proposed.grid().unit(point);
        self.free.iter().map(|&a| unit[a]).collect()
    }

    /// Fits and conditions the models, unless that was done for these data.
    fn train(&mut self) -> Option<(Trained, Vec<GridPoint>)> {
        if self.model.is_some() {
            return self.model.clone();
        }
        let x: Vec<Vec<f64>> = self.told.iter().map(|o| self.unit(&o.point)).collect();
        let count = |of: fn(&Observation) -> usize| self.told.iter().map(of).max().unwrap_or(0);
        let (objectives, constraints) = (count(|o| o.values.len()), count(|o| o.violations.len()));
        if objectives == 0 {
            return None;
        }
        let mut thetas = Vec::new();
        let mut models = Vec::new();
        for i in 0..objectives {
            let values: Vec<Option<f64>> =
                self.told.iter().map(|o| o.values.get(i).copied()).collect();
            let floor = self.noise_floors.get(i).copied().unwrap_or(0.0);
            let data = standardise(&values, floor)?;
            // Volumes are compared in the units of the objectives, improvements need no unit.
            let data = if objectives == 1 { data.warped() } else { data };
            models.push(self.fit(&x, &data, &mut thetas)?);
        }
        let mut margins = Vec::new();
        for i in 0..constraints {
            let values: Vec<Option<f64>> =
                self.told.iter().map(|o| o.violations.get(i).map(|v| -v)).collect();
            let data = standardise(&values, 0.0)?;
            margins.push(Margin { gp: self.fit(&x, &data, &mut thetas)?, zero: data.zero });
        }
        self.thetas = thetas;
        let trained = Trained { objectives: models, margins, goal: Goal::Feasible };
        self.model = Some(self.with_goal(trained, &x)?);
        self.model.clone()
    }

    /// One model, its hyperparameters fitted from those it had before.
    fn fit(
        &self,
        x: &[Vec<f64>],
        data: &Standardised,
        thetas: &mut Vec<Hyperparameters>,
    ) -> Option<Gp> {
        let effort = FitEffort::for_observations(x.len());
        let warm = self.thetas.get(thetas.len());
        let theta = fit(x, &data.values, data.noise_floor, warm, effort);
        thetas.push(theta.clone());
        Gp::new(x, &data.values, data.noise_floor, theta)
    }

    /// Sets the goal by what was told at `x`, and finds good points to start from.
    fn with_goal(&self, mut trained: Trained, x: &[Vec<f64>]) -> Option<(Trained, Vec<GridPoint>)> {
        let constrained = !trained.margins.is_empty();
        let feasible = |i: &usize| !constrained || self.told[*i].feasible();
        let known: Vec<usize> = (0..x.len()).filter(feasible).collect();
        let best_first = |of: &dyn Fn(&[f64]) -> f64, among: &[usize]| {
            let mut ranked: Vec<(f64, usize)> = among.iter().map(|&i| (of(&x[i]), i)).collect();
            ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
            ranked
        };
        let ranked = if known.is_empty() {
            let all: Vec<usize> = (0..x.len()).collect();
            best_first(&|x| trained.log_feasible(x), &all)
        } else if let [gp] = &trained.objectives[..] {
            let ranked = best_first(&|x| gp.predict(x).0, &known);
            trained.goal = Goal::Improve(ranked.first()?.0);
            ranked
        } else {
            let means =
                |x: &Vec<f64>| trained.objectives.iter().map(|gp| gp.predict(x).0).collect();
            let all: Vec<Vec<f64>> = x.iter().map(means).collect();
            let among: Vec<Vec<f64>> = known.iter().map(|&i| all[i].clone()).collect();
            let ends = front(&among).into_iter().map(|i| (0.0, known[i])).collect();
            trained.goal = Goal::Volume(Front::new(&among, &all));
            ends
        };
        let most = if matches!(trained.goal, Goal::Volume(_)) { ranked.len() } else { INCUMBENTS };
        let starts = ranked.iter().take(most).map(|&(_, i)| self.told[i].point.clone()).collect();
        Some((trained, starts))
    }

    fn suggest(&self, trained: &Trained, incumbents: &[GridPoint]) -> Option<GridPoint> {
        let search = Search {
            trained,
            proposed: &self.proposed,
            free: &self.free,
            incumbents,
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
        let mut trained: Option<(Trained, Vec<GridPoint>)> = None;
        while points.len() < n && !self.proposed.exhausted() {
            let mut found = None;
            if self.proposed.len() >= self.design_size() && !self.free.is_empty() {
                if trained.is_none() {
                    trained = self.train();
                    if let Some((trained, _)) = &mut trained {
                        for point in &self.pending {
                            trained.believe(&self.unit(point));
                        }
                    }
                }
                found = trained.as_ref().and_then(|(t, starts)| self.suggest(t, starts));
            }
            let found = found.or_else(|| self.fill()).filter(|p| self.proposed.insert(p));
            let Some(point) = found.or_else(|| self.proposed.next_unseen()) else { break };
            if let Some((trained, _)) = &mut trained {
                trained.believe(&self.unit(&point));
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
