//! Fitting of the models to the observations.

use super::data::{Standardised, evenly_spaced, standardise};
use super::fit::{FitEffort, fit};
use super::hyperparameters::Hyperparameters;
use super::local_models::{APPROXIMATE_NEIGHBOURS, LocalModels};
use super::local_search;
use super::search::{Search, SearchRegion};
use super::trained::{Front, Goal, TrainedModels};
use crate::pareto::front;
use crate::{GridPoint, Observation};
use std::collections::BTreeSet;

/// Number of incumbents, around which the acquisition is searched more closely.
pub(super) const INCUMBENTS: usize = 4;
/// Number of points with the largest values whose posterior means are compared if the models are local.
const LEADERS: usize = 16;
/// Largest number of observations to which the hyperparameters are fitted.
pub(super) const MAX_FITTED: usize = 200;
/// Beyond [`MAX_FITTED`] observations the hyperparameters are refitted when their number has grown by the fraction
/// `1 / REFIT`.
const REFIT: usize = 20;
/// Effort of a fit to a subset of the observations.
const EFFORT: FitEffort = FitEffort { evaluations: 12, restarts: false };

/// Gaussian processes conditioned on the observations.
#[derive(Debug, Clone)]
pub(super) enum Model {
    /// Processes conditioned on all points.
    Global(TrainedModels),
    /// Processes conditioned on the points nearest to a location, wherever one is needed.
    Local(LocalModels),
}

impl Model {
    /// Treats the posterior means at `x` as observations (kriging believer).
    pub fn believe(&mut self, x: &[f64]) {
        match self {
            Model::Global(trained) => trained.believe(x),
            Model::Local(known) => known.believe(x),
        }
    }

    /// Returns the unseen point with the largest acquisition found.
    pub fn suggest(&self, region: SearchRegion) -> Option<GridPoint> {
        match self {
            Model::Global(trained) => Search { trained, region }.maximise(),
            Model::Local(known) => local_search::maximise(known, region),
        }
    }
}

/// Hyperparameters of the last fit, and the settings of fits.
#[derive(Debug, Clone)]
pub(super) struct Training {
    /// Least standard deviation of the noise of each objective, in its units; 0 for objectives without an entry.
    noise_floors: Vec<f64>,
    /// Hyperparameters of the last fit, of the objectives, then of the constraints.
    thetas: Vec<Hyperparameters>,
    /// Number of observations at the last fit.
    last_count: usize,
}

impl Training {
    /// Creates the settings before the first fit. `noise_floors` are the least standard deviations of the noise of each
    /// objective, in its units; missing or non-positive entries count as zero.
    pub fn new(noise_floors: &[f64]) -> Self {
        let floor = |&floor: &f64| if floor.is_finite() { floor.max(0.0) } else { 0.0 };
        let noise_floors = noise_floors.iter().map(floor).collect();
        Training { noise_floors, thetas: Vec::new(), last_count: 0 }
    }

    /// Returns models of the observations `told` at the points `x`, global if `whole` and else local, and good starting
    /// points of a search, best first.
    pub fn model(
        &mut self,
        told: &[Observation],
        x: Vec<Vec<f64>>,
        whole: bool,
    ) -> Option<(Model, Vec<GridPoint>)> {
        let (data, zeros) = self.standardised(told)?;
        let (n, constrained) = (x.len(), !zeros.is_empty());
        let due = whole || n <= MAX_FITTED || n >= self.last_count + self.last_count / REFIT;
        if due || self.thetas.len() != data.len() {
            let (subset, effort) = match whole || n <= MAX_FITTED {
                true => ((0..n).collect(), FitEffort::for_observations(n)),
                false => (fitted_subset(&data[0].values), EFFORT),
            };
            self.thetas = self.fit_all(&x, &data, &subset, effort);
            self.last_count = n;
        }
        let mut known = LocalModels::new(x, data, self.thetas.clone(), zeros);
        if whole {
            let mut trained = known.models_of(&(0..n).collect())?;
            let (x, objectives) = (&known.x, &trained.models[..trained.objectives()]);
            let margin = |i: usize| trained.acquisition(&x[i]);
            let leaders = |feasible| best_first(|i| objectives[0].mean(&x[i]), feasible);
            let means = |i: usize| objectives.iter().map(|gp| gp.mean(&x[i])).collect();
            let (goal, starts) = goal(told, constrained, margin, leaders, means)?;
            trained.goal = goal;
            return Some((Model::Global(trained), starts));
        }
        // With many observations their values replace the posterior means.
        let (objectives, margins) = known.data.split_at(known.data.len() - known.zeros.len());
        let margin = |i: usize| {
            let margins =
                margins.iter().zip(&known.zeros).map(|(data, zero)| data.values[i] - zero);
            margins.fold(f64::INFINITY, f64::min)
        };
        let mean = |i: usize| {
            let near = known.near(&known.x[i], APPROXIMATE_NEIGHBOURS);
            near.map_or(f64::NEG_INFINITY, |near| near.models[0].mean(&known.x[i]))
        };
        let leaders = |feasible: Vec<usize>| {
            let among = best_first(|i| objectives[0].values[i], feasible);
            best_first(mean, among.into_iter().take(LEADERS).map(|(_, i)| i))
        };
        let means = |i: usize| objectives.iter().map(|data| data.values[i]).collect();
        let (goal, starts) = goal(told, constrained, margin, leaders, means)?;
        known.goal = goal;
        Some((Model::Local(known), starts))
    }

    /// Returns the values of the objectives, then the margins of the constraints, in the units of the models,
    /// and the smallest feasible margins; `None` if no observation has a value.
    fn standardised(&self, told: &[Observation]) -> Option<(Vec<Standardised>, Vec<f64>)> {
        let count = |of: fn(&Observation) -> usize| told.iter().map(of).max().unwrap_or(0);
        let (objectives, constraints) = (count(|o| o.values.len()), count(|o| o.violations.len()));
        if objectives == 0 {
            return None;
        }
        let objective = |i: usize| {
            let values: Vec<Option<f64>> = told.iter().map(|o| o.values.get(i).copied()).collect();
            let data = standardise(&values, self.noise_floors.get(i).copied().unwrap_or(0.0))?;
            // A transformation would distort hypervolumes; the improvement of a single objective needs no unit.
            Some(if objectives == 1 { data.warped() } else { data })
        };
        let margin = |i: usize| {
            let values: Vec<Option<f64>> =
                told.iter().map(|o| o.violations.get(i).map(|v| -v)).collect();
            standardise(&values, 0.0)
        };
        let all = (0..objectives).map(objective).chain((0..constraints).map(margin));
        let data = all.collect::<Option<Vec<_>>>()?;
        let zeros = data[objectives..].iter().map(|data| data.zero).collect();
        Some((data, zeros))
    }

    /// Fits the hyperparameters of each model to a subset of its values, starting from those of the last fit.
    fn fit_all(
        &self,
        x: &[Vec<f64>],
        data: &[Standardised],
        subset: &BTreeSet<usize>,
        effort: FitEffort,
    ) -> Vec<Hyperparameters> {
        let x: Vec<Vec<f64>> = subset.iter().map(|&i| x[i].clone()).collect();
        let of = |(i, data): (usize, &Standardised)| {
            let y: Vec<f64> = subset.iter().map(|&i| data.values[i]).collect();
            fit(&x, &y, data.noise_floor, self.thetas.get(i), (effort, &|| false))
        };
        data.iter().enumerate().map(of).collect()
    }
}

/// Returns the indices of the values to which hyperparameters are fitted: the `MAX_FITTED / 2` largest ones, near
/// which the search continues, and as many evenly selected from all.
fn fitted_subset(values: &[f64]) -> BTreeSet<usize> {
    let n = values.len();
    let leaders = best_first(|i| values[i], 0..n).into_iter().take(MAX_FITTED / 2);
    evenly_spaced(n, MAX_FITTED / 2).chain(leaders.map(|(_, i)| i)).collect()
}

/// Returns indices with their values, the largest value first.
fn best_first(
    of: impl Fn(usize) -> f64,
    among: impl IntoIterator<Item = usize>,
) -> Vec<(f64, usize)> {
    let mut ranked: Vec<(f64, usize)> = among.into_iter().map(|i| (of(i), i)).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked
}

/// Returns the goal for the observations, and good starting points. `margin` ranks observations by
/// feasibility; `leaders` ranks them by the mean of the single objective; `means` returns those of all
/// objectives.
fn goal(
    told: &[Observation],
    constrained: bool,
    margin: impl Fn(usize) -> f64,
    leaders: impl Fn(Vec<usize>) -> Vec<(f64, usize)>,
    means: impl Fn(usize) -> Vec<f64>,
) -> Option<(Goal, Vec<GridPoint>)> {
    let all = 0..told.len();
    let feasible: Vec<usize> =
        all.clone().filter(|&i| !constrained || told[i].feasible()).collect();
    let point = |i: usize| told[i].point.clone();
    if !feasible.is_empty() && told.iter().any(|o| o.values.len() > 1) {
        let all: Vec<Vec<f64>> = all.map(means).collect();
        let among: Vec<Vec<f64>> = feasible.iter().map(|&i| all[i].clone()).collect();
        let starts = front(&among).into_iter().map(|i| point(feasible[i])).collect();
        return Some((Goal::Volume(Front::new(&among, &all)), starts));
    }
    let (goal, ranked) = if feasible.is_empty() {
        (Goal::Feasible, best_first(margin, all))
    } else {
        let ranked = leaders(feasible);
        (Goal::Improve(ranked.first()?.0), ranked)
    };
    Some((goal, ranked.into_iter().take(INCUMBENTS).map(|(_, i)| point(i)).collect()))
}
