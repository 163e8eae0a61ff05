//! The models of all objectives and constraints, and what is looked for with them.

use super::acquisition::{log_expected_improvement, log_expected_volume, log_probability_above};
use super::model::Gp;
use crate::evaluation::pareto::{Cell, front, undominated};

/// Models of what was told, and the goal they are used for.
#[derive(Debug, Clone)]
pub(super) struct Trained {
    /// One model per objective.
    pub objectives: Vec<Gp>,
    /// One model per constraint.
    pub margins: Vec<Margin>,
    /// What is looked for.
    pub goal: Goal,
}

/// The model of how far a constraint is kept; kept from `zero` on.
#[derive(Debug, Clone)]
pub(super) struct Margin {
    /// The model.
    pub gp: Gp,
    /// No margin, in the model's units.
    pub zero: f64,
}

/// What a point is wanted for.
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
    points: Vec<Vec<f64>>,
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
        let points: Vec<Vec<f64>> =
            front(feasible).into_iter().map(|i| feasible[i].clone()).collect();
        let cells = undominated(&points, &reference);
        Front { points, reference, cells }
    }

    fn add(&mut self, point: Vec<f64>) {
        self.points.push(point);
        self.points = front(&self.points).into_iter().map(|i| self.points[i].clone()).collect();
        self.cells = undominated(&self.points, &self.reference);
    }
}

impl Trained {
    /// Observations and believed points together.
    pub fn len(&self) -> usize {
        self.objectives.first().map_or(0, Gp::len)
    }

    /// Number of models.
    pub fn models(&self) -> usize {
        self.objectives.len() + self.margins.len()
    }

    /// Takes the posterior means at `x` for observed.
    pub fn believe(&mut self, x: &[f64]) {
        if let Goal::Volume(front) = &mut self.goal
            && self.margins.iter().all(|margin| margin.gp.predict(x).0 >= margin.zero)
        {
            front.add(self.objectives.iter().map(|gp| gp.predict(x).0).collect());
        }
        self.objectives.iter_mut().for_each(|gp| gp.believe(x));
        self.margins.iter_mut().for_each(|margin| margin.gp.believe(x));
    }

    /// Log of the probability that a point keeps all constraints.
    pub fn log_feasible(&self, x: &[f64]) -> f64 {
        let log = |margin: &Margin| {
            let (mean, variance) = margin.gp.predict(x);
            log_probability_above(mean, variance.sqrt(), margin.zero)
        };
        self.margins.iter().map(log).sum()
    }

    /// Log of what a point promises: its expected improvement or volume, times its probability
    /// of keeping the constraints (Gardner et al. 2014, ICML 32:937).
    pub fn promise(&self, x: &[f64]) -> f64 {
        let moments = || self.objectives.iter().map(|gp| gp.predict(x));
        let gain = match &self.goal {
            Goal::Feasible => 0.0,
            Goal::Improve(best) => {
                moments().next().map_or(f64::NEG_INFINITY, |m| log_ei(m.0, m.1, *best))
            }
            Goal::Volume(front) => {
                let moments: Vec<_> = moments().map(|(mean, v)| (mean, v.sqrt())).collect();
                log_expected_volume(&moments, &front.cells)
            }
        };
        gain + self.log_feasible(x)
    }

    /// A bound of [`promise`](Self::promise) that needs no triangular solve; `k` is scratch.
    pub fn bound(&self, x: &[f64], k: &mut Vec<f64>) -> f64 {
        let (Goal::Improve(best), Some(gp)) = (&self.goal, self.objectives.first()) else {
            return f64::INFINITY;
        };
        gp.cross(x, k);
        let glance = gp.glance(k);
        log_ei(glance.mean, glance.variance_bound, *best)
    }

    /// The promise, or `None` as soon as it is known not to be above `record`; `k` is scratch.
    pub fn promise_above(&self, record: f64, x: &[f64], k: &mut Vec<f64>) -> Option<f64> {
        let (Goal::Improve(best), [gp]) = (&self.goal, &self.objectives[..]) else {
            return Some(self.promise(x));
        };
        gp.cross(x, k);
        let mean = gp.glance(k).mean;
        let variance = gp.variance(k, |variance| log_ei(mean, variance, *best) <= record)?;
        Some(log_ei(mean, variance, *best) + self.log_feasible(x))
    }
}

fn log_ei(mean: f64, variance: f64, best: f64) -> f64 {
    log_expected_improvement(mean, variance.sqrt(), best)
}
