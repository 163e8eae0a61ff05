//! The models of all objectives and constraints, and what is looked for with them.

use super::acquisition::{log_expected_improvement, log_expected_volume, log_probability_above};
use super::model::{Gp, Sloped};
use crate::pareto::{Archive, Cell, undominated};

/// Step of the differences by the moments, in standard deviations.
const DIFFERENCE: f64 = 1e-4;

/// Models of what was told, and the goal they are used for.
#[derive(Debug, Clone)]
pub(super) struct Trained {
    /// Of each objective, then of how far each constraint is kept.
    pub models: Vec<Gp>,
    /// Values from which on the constraints are kept, in the models' units.
    pub zeros: Vec<f64>,
    pub goal: Goal,
}

/// Use of a point.
#[derive(Debug, Clone)]
pub(super) enum Goal {
    /// Improvement over this value of the only objective, in the model's units.
    Improve(f64),
    /// Volume beyond the front of several objectives.
    Volume(Front),
    /// Any point that keeps the constraints: none is known yet.
    Feasible,
}

/// The front so far, in the models' units.
#[derive(Debug, Clone)]
pub(super) struct Front {
    points: Archive,
    reference: Vec<f64>,
    cells: Vec<Cell>,
}

impl Front {
    /// Of the posterior means at feasible points. The reference is the worst of `all` means,
    /// at whatever points: above the worst corner of the front alone, its ends would not grow.
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

impl Trained {
    /// Observations and believed points together.
    pub fn len(&self) -> usize {
        self.models.first().map_or(0, Gp::len)
    }

    pub fn objectives(&self) -> usize {
        self.models.len() - self.zeros.len()
    }

    /// Takes the posterior means at `x` for observed.
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

    /// Log of what a point is wanted for: its expected improvement or volume, times its
    /// probability of keeping the constraints (Gardner et al. 2014, ICML 32:937).
    pub fn acquisition(&self, x: &[f64]) -> f64 {
        let moments = |gp: &Gp| {
            let (mean, variance) = gp.predict(x);
            (mean, variance.sqrt())
        };
        self.acquisition_of(&self.models.iter().map(moments).collect::<Vec<_>>())
    }

    /// The acquisition and its derivatives by the coordinates of the point; `None` where it
    /// is not finite. Exact through the processes; by the moments of each, which cost next to
    /// nothing, central differences.
    pub fn sloped_acquisition(&self, x: &[f64]) -> Option<(f64, Vec<f64>)> {
        let sloped: Vec<Sloped> = self.models.iter().map(|gp| gp.sloped(x)).collect();
        let mut moments: Vec<(f64, f64)> =
            sloped.iter().map(|s| (s.mean, s.variance.sqrt())).collect();
        let value = self.acquisition_of(&moments);
        let mut slope = vec![0.0; x.len()];
        for (i, sloped) in sloped.iter().enumerate() {
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
            for (axis, slope) in slope.iter_mut().enumerate() {
                *slope += by_mean * sloped.mean_slope[axis]
                    + by_deviation * sloped.variance_slope[axis] / (2.0 * deviation);
            }
        }
        let finite = value.is_finite() && slope.iter().all(|g| g.is_finite());
        finite.then_some((value, slope))
    }

    /// Of the means and standard deviations by all models.
    fn acquisition_of(&self, moments: &[(f64, f64)]) -> f64 {
        let (objectives, margins) = moments.split_at(self.objectives());
        let gain = match &self.goal {
            Goal::Feasible => 0.0,
            Goal::Improve(best) => {
                log_expected_improvement(objectives[0].0, objectives[0].1, *best)
            }
            Goal::Volume(front) => log_expected_volume(objectives, &front.cells),
        };
        let feasible = margins.iter().zip(&self.zeros);
        let log =
            |(&(mean, std), &zero): (&(f64, f64), &f64)| log_probability_above(mean, std, zero);
        gain + feasible.map(log).sum::<f64>()
    }

    /// A bound of [`acquisition`](Self::acquisition) that needs no triangular solution.
    pub fn bound(&self, x: &[f64]) -> f64 {
        let (Goal::Improve(best), [gp, ..]) = (&self.goal, &self.models[..]) else {
            return f64::INFINITY;
        };
        let (mean, variance) = gp.bound(x);
        log_expected_improvement(mean, variance.sqrt(), *best)
    }
}
