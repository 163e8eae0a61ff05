//! The models of all objectives and constraints, and what is looked for with them.

use super::acquisition::{log_expected_improvement, log_expected_volume, log_probability_above};
use super::model::{Gp, Sloped};
use crate::pareto::{Cell, front, undominated};

/// Step of the differences by the moments, in standard deviations.
const DIFFERENCE: f64 = 1e-4;

/// Mean and standard deviation of one process at a point.
#[derive(Debug, Clone, Copy)]
struct Moments {
    mean: f64,
    deviation: f64,
}

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

    /// Log of what a point is wanted for: its expected improvement or volume, times its
    /// probability of keeping the constraints (Gardner et al. 2014, ICML 32:937).
    pub fn acquisition(&self, x: &[f64]) -> f64 {
        let moments: Vec<Moments> = self
            .processes()
            .map(|gp| {
                let (mean, variance) = gp.predict(x);
                Moments { mean, deviation: variance.sqrt() }
            })
            .collect();
        self.acquisition_of(&moments)
    }

    /// The acquisition and its derivatives by the coordinates of the point; `None` where it
    /// is not finite. Exact through the processes; by the moments of each, which cost next to
    /// nothing, central differences.
    pub fn sloped_acquisition(&self, x: &[f64]) -> Option<(f64, Vec<f64>)> {
        let sloped: Vec<Sloped> = self.processes().map(|gp| gp.sloped(x)).collect();
        let of = |s: &Sloped| Moments { mean: s.mean, deviation: s.variance.sqrt() };
        let mut moments: Vec<Moments> = sloped.iter().map(of).collect();
        let value = self.acquisition_of(&moments);
        let mut slope = vec![0.0; x.len()];
        for (i, sloped) in sloped.iter().enumerate() {
            let here = moments[i];
            let step = DIFFERENCE * here.deviation;
            let mut at = |mean: f64, deviation: f64| {
                moments[i] = Moments { mean, deviation };
                self.acquisition_of(&moments)
            };
            let Moments { mean, deviation } = here;
            let by_mean = (at(mean + step, deviation) - at(mean - step, deviation)) / (2.0 * step);
            let by_deviation =
                (at(mean, deviation + step) - at(mean, deviation - step)) / (2.0 * step);
            moments[i] = here;
            for (axis, slope) in slope.iter_mut().enumerate() {
                *slope += by_mean * sloped.mean_slope[axis]
                    + by_deviation * sloped.variance_slope[axis] / (2.0 * deviation);
            }
        }
        let finite = value.is_finite() && slope.iter().all(|g| g.is_finite());
        finite.then_some((value, slope))
    }

    /// Objectives, then constraints.
    fn processes(&self) -> impl Iterator<Item = &Gp> {
        self.objectives.iter().chain(self.margins.iter().map(|margin| &margin.gp))
    }

    /// Of the moments of all processes, in their order.
    fn acquisition_of(&self, moments: &[Moments]) -> f64 {
        let (objectives, margins) = moments.split_at(self.objectives.len());
        let gain = match &self.goal {
            Goal::Feasible => 0.0,
            Goal::Improve(best) => objectives.first().map_or(f64::NEG_INFINITY, |m| {
                log_expected_improvement(m.mean, m.deviation, *best)
            }),
            Goal::Volume(front) => {
                let pairs: Vec<_> = objectives.iter().map(|m| (m.mean, m.deviation)).collect();
                log_expected_volume(&pairs, &front.cells)
            }
        };
        let feasible = margins.iter().zip(&self.margins);
        gain + feasible
            .map(|(m, margin)| log_probability_above(m.mean, m.deviation, margin.zero))
            .sum::<f64>()
    }

    /// A bound of [`acquisition`](Self::acquisition) that needs no triangular solution.
    pub fn bound(&self, x: &[f64]) -> f64 {
        let (Goal::Improve(best), Some(gp)) = (&self.goal, self.objectives.first()) else {
            return f64::INFINITY;
        };
        let k = gp.covariances(x);
        log_expected_improvement(gp.mean_at(&k), gp.variance_bound(&k).sqrt(), *best)
    }
}
