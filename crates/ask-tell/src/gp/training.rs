//! From what was told to models.

use super::data::{Standardised, standardise};
use super::fit::{FitEffort, fit};
use super::hyperparameters::Hyperparameters;
use super::local_search::LocalSearch;
use super::model::Gp;
use super::neighbours::{FEW, Neighbours, Process};
use super::search::{Room, Search};
use super::spread::spread;
use super::trained::{Front, Goal, Margin, Trained};
use crate::GridPoint;
use crate::Observation;
use crate::pareto::front;

/// Points around which the acquisition is searched more closely.
const INCUMBENTS: usize = 4;
/// Of one objective, points of the largest values among which the best mean is looked for, where
/// not all are.
const LEADERS: usize = 16;
/// Observations beyond which the hyperparameters are fitted to some of them.
const FITTED: usize = 200;
/// One more of so many observations is a reason to fit anew, beyond [`FITTED`].
const REFIT: usize = 20;
/// Of a fit to some of the observations.
const EFFORT: FitEffort = FitEffort { evaluations: 12, restarts: false };

/// What was told, as models.
#[derive(Debug, Clone)]
pub(super) enum Model {
    /// One process, or a process for each objective and constraint, of all points.
    Whole(Trained),
    /// Processes of some points, made where they are needed.
    Local(Neighbours),
}

impl Model {
    /// Takes the posterior means at `x` for observed.
    pub fn believe(&mut self, x: &[f64]) {
        match self {
            Model::Whole(trained) => trained.believe(x),
            Model::Local(known) => known.believe(x),
        }
    }

    /// The unseen point found with the largest acquisition.
    pub fn suggest(&self, room: Room) -> Option<GridPoint> {
        match self {
            Model::Whole(trained) => Search { trained, room }.maximise(),
            Model::Local(known) => LocalSearch { known, room }.maximise(),
        }
    }
}

/// Hyperparameters, and the values that they are fitted to.
#[derive(Debug, Clone)]
pub(super) struct Training {
    /// Least standard deviation of the noise of each objective; 0 for those beyond the last.
    noise_floors: Vec<f64>,
    /// Of the last fit, objectives first, then constraints.
    thetas: Vec<Hyperparameters>,
    /// Observations at the last fit.
    fitted: usize,
}

impl Training {
    /// `noise_floors`: least standard deviation of the noise of each objective, in its units;
    /// what is missing or not a positive number counts as zero.
    pub fn new(noise_floors: &[f64]) -> Self {
        let floor = |&floor: &f64| if floor.is_finite() { floor.max(0.0) } else { 0.0 };
        let noise_floors = noise_floors.iter().map(floor).collect();
        Training { noise_floors, thetas: Vec::new(), fitted: 0 }
    }

    /// The models of what was `told` at `x`, and good points to start a search from, best first.
    pub fn whole(
        &mut self,
        told: &[Observation],
        x: &[Vec<f64>],
    ) -> Option<(Model, Vec<GridPoint>)> {
        let (objectives, constraints) = self.standardised(told)?;
        let thetas = self.fitted(x, objectives.iter().chain(&constraints), None);
        let model = |(data, theta): (&Standardised, &Hyperparameters)| {
            Gp::new(x, &data.values, data.noise_floor, theta.clone())
        };
        let (of_objectives, of_constraints) = thetas.split_at(objectives.len());
        let margin = |(data, theta): (&Standardised, &Hyperparameters)| {
            Some(Margin { gp: model((data, theta))?, zero: data.zero })
        };
        let mut trained = Trained {
            objectives: objectives.iter().zip(of_objectives).map(model).collect::<Option<_>>()?,
            margins: constraints.iter().zip(of_constraints).map(margin).collect::<Option<_>>()?,
            goal: Goal::Feasible,
        };
        (self.thetas, self.fitted) = (thetas, x.len());
        let (goal, starts) = goal_of_whole(&trained, told, x)?;
        trained.goal = goal;
        Some((Model::Whole(trained), starts))
    }

    /// The same with models of the neighbours of a place.
    pub fn local(
        &mut self,
        told: &[Observation],
        x: Vec<Vec<f64>>,
    ) -> Option<(Model, Vec<GridPoint>)> {
        let (objectives, constraints) = self.standardised(told)?;
        let models = objectives.len() + constraints.len();
        let due = x.len() <= FITTED || x.len() >= self.fitted + self.fitted / REFIT;
        if due || self.thetas.len() != models {
            let some = some_of(&objectives, x.len());
            let all = objectives.iter().chain(&constraints);
            self.thetas = self.fitted(&x, all, some.as_deref());
            self.fitted = x.len();
        }
        let process = |(data, theta): (Standardised, &Hyperparameters)| Process {
            data,
            theta: theta.clone(),
        };
        let (of_objectives, of_constraints) = self.thetas.split_at(objectives.len());
        let objectives = objectives.into_iter().zip(of_objectives).map(process).collect();
        let constraints = constraints.into_iter().zip(of_constraints).map(process).collect();
        let mut known = Neighbours::new(x, objectives, constraints);
        let (goal, starts) = goal_of_neighbours(&known, told)?;
        known.goal = goal;
        Some((Model::Local(known), starts))
    }

    /// Values of the objectives and margins of the constraints in the models' units; `None` if
    /// nothing has a value.
    fn standardised(&self, told: &[Observation]) -> Option<(Vec<Standardised>, Vec<Standardised>)> {
        let count = |of: fn(&Observation) -> usize| told.iter().map(of).max().unwrap_or(0);
        let (objectives, constraints) = (count(|o| o.values.len()), count(|o| o.violations.len()));
        if objectives == 0 {
            return None;
        }
        let objective = |i: usize| {
            let values: Vec<Option<f64>> = told.iter().map(|o| o.values.get(i).copied()).collect();
            let data = standardise(&values, self.noise_floors.get(i).copied().unwrap_or(0.0))?;
            // Volumes are compared in the units of the objectives, improvements need no unit.
            Some(if objectives == 1 { data.warped() } else { data })
        };
        let margin = |i: usize| {
            let values: Vec<Option<f64>> =
                told.iter().map(|o| o.violations.get(i).map(|v| -v)).collect();
            standardise(&values, 0.0)
        };
        let objectives = (0..objectives).map(objective).collect::<Option<_>>()?;
        Some((objectives, (0..constraints).map(margin).collect::<Option<_>>()?))
    }

    /// Hyperparameters of each, fitted from those it had before, to `some` of its values or all.
    fn fitted<'a>(
        &self,
        x: &[Vec<f64>],
        data: impl Iterator<Item = &'a Standardised>,
        some: Option<&[usize]>,
    ) -> Vec<Hyperparameters> {
        let of = |(i, data): (usize, &Standardised)| {
            let warm = self.thetas.get(i);
            let Some(some) = some else {
                let effort = FitEffort::for_observations(x.len());
                return fit(x, &data.values, data.noise_floor, warm, effort);
            };
            let x: Vec<Vec<f64>> = some.iter().map(|&i| x[i].clone()).collect();
            let y: Vec<f64> = some.iter().map(|&i| data.values[i]).collect();
            fit(&x, &y, data.noise_floor, warm, EFFORT)
        };
        data.enumerate().map(of).collect()
    }
}

/// Which of `n` values are fitted to: the largest of the first objective, about which the search
/// goes on, and as many evenly of all; `None` for all.
fn some_of(objectives: &[Standardised], n: usize) -> Option<Vec<usize>> {
    if n <= FITTED {
        return None;
    }
    let mut some: Vec<usize> = spread(n, FITTED / 2).collect();
    some.extend(leaders(&objectives.first()?.values, |_| true).take(FITTED / 2));
    some.sort_unstable();
    some.dedup();
    Some(some)
}

/// Places of the values that count, the largest value first.
fn leaders(values: &[f64], counts: impl Fn(usize) -> bool) -> impl Iterator<Item = usize> {
    let mut places: Vec<usize> = (0..values.len()).filter(|&i| counts(i)).collect();
    places.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    places.into_iter()
}

/// Places with their numbers, the largest number first.
fn best_first(of: impl Fn(usize) -> f64, among: impl Iterator<Item = usize>) -> Vec<(f64, usize)> {
    let mut ranked: Vec<(f64, usize)> = among.map(|i| (of(i), i)).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked
}

/// What is looked for by what was told at `x`, and good points to start from.
fn goal_of_whole(
    trained: &Trained,
    told: &[Observation],
    x: &[Vec<f64>],
) -> Option<(Goal, Vec<GridPoint>)> {
    let known = known(told, trained.margins.is_empty());
    let points = |ranked: Vec<(f64, usize)>| {
        ranked.iter().take(INCUMBENTS).map(|&(_, i)| told[i].point.clone()).collect()
    };
    if known.is_empty() {
        let ranked = best_first(|i| trained.log_feasible(&x[i]), 0..x.len());
        return Some((Goal::Feasible, points(ranked)));
    }
    if let [gp] = &trained.objectives[..] {
        let ranked = best_first(|i| gp.predict(&x[i]).0, known.into_iter());
        return Some((Goal::Improve(ranked.first()?.0), points(ranked)));
    }
    let means = |x: &Vec<f64>| trained.objectives.iter().map(|gp| gp.predict(x).0).collect();
    Some(volume(&x.iter().map(means).collect::<Vec<_>>(), &known, told))
}

/// The same of neighbours, whose told values are taken for means where there are many.
fn goal_of_neighbours(known: &Neighbours, told: &[Observation]) -> Option<(Goal, Vec<GridPoint>)> {
    let feasible = self::known(told, known.margins.is_empty());
    let point = |i: usize| told[i].point.clone();
    if feasible.is_empty() {
        let margin = |i: usize| {
            let margins = known.margins.iter().map(|p| p.data.values[i] - p.data.zero);
            margins.fold(f64::INFINITY, f64::min)
        };
        let ranked = best_first(margin, 0..told.len());
        return Some((
            Goal::Feasible,
            ranked.iter().take(INCUMBENTS).map(|r| point(r.1)).collect(),
        ));
    }
    if let [objective] = &known.objectives[..] {
        let among = best_first(|i| objective.data.values[i], feasible.into_iter());
        let mean = |i: usize| {
            let x = &known.x[i];
            known.about(x, FEW).and_then(|near| Some(near.objectives.first()?.mean(x)))
        };
        let leaders = among.iter().take(LEADERS).map(|&(_, i)| i);
        let ranked = best_first(|i| mean(i).unwrap_or(f64::NEG_INFINITY), leaders);
        let starts = ranked.iter().take(INCUMBENTS).map(|r| point(r.1)).collect();
        return Some((Goal::Improve(ranked.first()?.0), starts));
    }
    let means = |i: usize| known.objectives.iter().map(|p| p.data.values[i]).collect();
    Some(volume(&(0..told.len()).map(means).collect::<Vec<_>>(), &feasible, told))
}

/// Which points may be the best: the feasible ones.
fn known(told: &[Observation], unconstrained: bool) -> Vec<usize> {
    (0..told.len()).filter(|&i| unconstrained || told[i].feasible()).collect()
}

/// Volume beyond the front of the means of the feasible points, and its points.
fn volume(all: &[Vec<f64>], feasible: &[usize], told: &[Observation]) -> (Goal, Vec<GridPoint>) {
    let among: Vec<Vec<f64>> = feasible.iter().map(|&i| all[i].clone()).collect();
    let starts = front(&among).into_iter().map(|i| told[feasible[i]].point.clone()).collect();
    (Goal::Volume(Front::new(&among, all)), starts)
}
