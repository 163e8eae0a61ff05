//! Models of all objectives and constraints, and the acquisition function.

use super::acquisition::{log_expected_improvement, log_expected_volume, log_probability_above};
use super::model::Gp;
use crate::pareto::{Archive, Cell, undominated};

/// Step of the central differences with respect to the moments, in standard deviations.
const DIFFERENCE: f64 = 1e-4;

/// Models of the observations, and the goal of the acquisition function.
#[derive(Debug, Clone)]
pub(super) struct TrainedModels {
    /// Model of each objective, then of the margin of each constraint (the negated violation).
    pub models: Vec<Gp>,
    /// Margin 0 of each constraint, the smallest feasible one, in the units of its model.
    pub zeros: Vec<f64>,
    pub goal: Goal,
}

/// Goal of the acquisition function.
#[derive(Debug, Clone)]
pub(super) enum Goal {
    /// Improvement over this value of the single objective, in the units of its model.
    Improve(f64),
    /// Hypervolume added to the Pareto front of several objectives.
    Volume(Front),
    /// A feasible point, while none is known.
    Feasible,
}

/// Pareto front of the observations, in the units of the models.
#[derive(Debug, Clone)]
pub(super) struct Front {
    points: Archive,
    reference: Vec<f64>,
    cells: Vec<Cell>,
}

impl Front {
    /// Returns the front of the posterior means at feasible points. The reference is the componentwise
    /// minimum over `all` points: with that of the front alone, points beyond its ends would add no volume.
    pub fn new(feasible: &[Vec<f64>], all: &[Vec<f64>]) -> Self {
        let worst = |reference: Vec<f64>, point: &Vec<f64>| {
            reference.iter().zip(point).map(|(a, b)| a.min(*b)).collect()
        };
        let first = all.first().cloned().unwrap_or_default();
        let reference = all.iter().fold(first, worst);
        let mut points = Archive::default();
        for point in feasible {
            points.add(point.clone());
        }
        let cells = undominated(points.points(), &reference);
        Front { points, reference, cells }
    }

    fn add(&mut self, point: Vec<f64>) {
        self.points.add(point);
        self.cells = undominated(self.points.points(), &self.reference);
    }
}

impl TrainedModels {
    /// Returns the number of observations and of posterior means treated as such.
    pub fn len(&self) -> usize {
        self.models.first().map_or(0, Gp::len)
    }

    pub fn objectives(&self) -> usize {
        self.models.len() - self.zeros.len()
    }

    /// Treats the posterior means at `x` as observations (kriging believer).
    pub fn believe(&mut self, x: &[f64]) {
        let mut means: Vec<f64> = self.models.iter().map(|gp| gp.mean(x)).collect();
        let margins = means.split_off(self.objectives());
        if let Goal::Volume(front) = &mut self.goal
            && margins.iter().zip(&self.zeros).all(|(margin, zero)| margin >= zero)
        {
            front.add(means);
        }
        self.models.iter_mut().for_each(|gp| gp.believe(x));
    }

    /// Returns the logarithm of the expected improvement (or hypervolume improvement) times the probability of
    /// feasibility (Gardner et al. 2014, ICML 32:937).
    pub fn acquisition(&self, x: &[f64]) -> f64 {
        let moments = |gp: &Gp| {
            let (mean, variance) = gp.predict(x);
            (mean, variance.sqrt())
        };
        self.acquisition_of(&self.models.iter().map(moments).collect::<Vec<_>>())
    }

    /// Returns the acquisition and its gradient; `None` where it is not finite. The derivatives of the
    /// posterior moments are exact; those with respect to the moments, which are cheap, are central
    /// differences.
    pub fn acquisition_and_gradient(&self, x: &[f64]) -> Option<(f64, Vec<f64>)> {
        let posteriors: Vec<_> = self.models.iter().map(|gp| gp.posterior_gradient(x)).collect();
        let mut moments: Vec<(f64, f64)> =
            posteriors.iter().map(|p| (p.mean, p.variance.sqrt())).collect();
        let value = self.acquisition_of(&moments);
        let mut gradient = vec![0.0; x.len()];
        for (i, posterior) in posteriors.iter().enumerate() {
            let (mean, deviation) = moments[i];
            let step = DIFFERENCE * deviation;
            let mut at = |mean: f64, deviation: f64| {
                moments[i] = (mean, deviation);
                self.acquisition_of(&moments)
            };
            let by_mean = (at(mean + step, deviation) - at(mean - step, deviation)) / (2.0 * step);
            let by_deviation =
                (at(mean, deviation + step) - at(mean, deviation - step)) / (2.0 * step);
            moments[i] = (mean, deviation);
            for (axis, gradient) in gradient.iter_mut().enumerate() {
                *gradient += by_mean * posterior.mean_slope[axis]
                    + by_deviation * posterior.variance_slope[axis] / (2.0 * deviation);
            }
        }
        let finite = value.is_finite() && gradient.iter().all(|g| g.is_finite());
        finite.then_some((value, gradient))
    }

    /// Returns the acquisition for these means and standard deviations of all models.
    fn acquisition_of(&self, moments: &[(f64, f64)]) -> f64 {
        let (objectives, margins) = moments.split_at(self.objectives());
        let gain = match &self.goal {
            Goal::Feasible => 0.0,
            Goal::Improve(best) => {
                log_expected_improvement(objectives[0].0, objectives[0].1, *best)
            }
            Goal::Volume(front) => log_expected_volume(objectives, &front.cells),
        };
        let margins = margins.iter().zip(&self.zeros);
        let logs = margins.map(|(&(mean, std), &zero)| log_probability_above(mean, std, zero));
        gain + logs.sum::<f64>()
    }

    /// Returns an upper bound of [`acquisition`](Self::acquisition) that needs no triangular solve.
    pub fn bound(&self, x: &[f64]) -> f64 {
        let (Goal::Improve(best), [gp, ..]) = (&self.goal, &self.models[..]) else {
            return f64::INFINITY;
        };
        let (mean, variance) = gp.bound(x);
        log_expected_improvement(mean, variance.sqrt(), *best)
    }
}
