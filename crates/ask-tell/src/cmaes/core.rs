//! Single run of CMA-ES on R^n, with an ask-and-tell interface.

use super::parameters::Parameters;
use super::stop::{History, Tolerances};
use crate::normal::StandardNormal;
use crate::stream::stream;
use libm::{exp, pow, sqrt};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rand::RngExt;

/// Largest condition number of C; above it a run ends.
const MAX_CONDITION: f64 = 1e14;
/// Largest number of iterations of an eigendecomposition (which usually takes a few per axis).
const EIGEN_ITERATIONS: usize = 1000;

/// Box from which the start of every run is drawn uniformly, with the settings common to all runs.
#[derive(Debug, Clone, PartialEq)]
pub struct StartBox {
    /// Lower corner.
    pub low: Vec<f64>,
    /// Upper corner.
    pub high: Vec<f64>,
    /// Step size of the first run and of runs with large population, units of x.
    pub sigma: f64,
    /// Least standard deviation per coordinate; empty for none.
    pub min_std: Vec<f64>,
    /// Largest population size.
    pub max_lambda: usize,
    /// Termination tolerances.
    pub tolerances: Tolerances,
}

/// Settings of a single run.
#[derive(Debug, Clone)]
pub(super) struct RunSettings {
    pub lambda: usize,
    /// Factor on the initial step size.
    pub sigma_factor: f64,
    /// Limit on generations, in addition to the general one.
    pub limit: u64,
}

/// A candidate and its value, smaller is better; NaN counts as positive infinity.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// The candidate, as returned by `ask`.
    pub x: Vec<f64>,
    /// Its value.
    pub value: f64,
}

/// CMA-ES, which **minimises**, in the symbols and with the equation numbers of Hansen's tutorial (see `cmaes`).
#[derive(Debug, Clone)]
pub(super) struct CmaEs {
    n: usize,
    start: StartBox,
    /// Initial step size.
    first_sigma: f64,
    max_generations: u64,
    /// Population size.
    pub lambda: usize,
    pub mean: DVector<f64>,
    sigma: f64,
    /// Covariance matrix C; only the lower triangle is updated.
    c: DMatrix<f64>,
    /// Eigenvectors of C, in columns.
    b: DMatrix<f64>,
    /// Square roots of the eigenvalues of C.
    d: DVector<f64>,
    /// Evolution path of the step size.
    p_sigma: DVector<f64>,
    /// Evolution path of C.
    p_c: DVector<f64>,
    /// Number of generations so far.
    pub generation: u64,
    history: History,
    seed: u64,
    purpose: String,
    /// Number of candidates drawn.
    samples: u64,
}

impl CmaEs {
    /// Creates run number `run`, which draws from its own random streams of `seed`.
    pub fn new(start: &StartBox, seed: u64, run: u64, settings: RunSettings) -> Self {
        let RunSettings { lambda, sigma_factor, limit } = settings;
        let mut random = stream(seed, run, "cma-es start");
        let uniform = |(l, h): (&f64, &f64)| l + (h - l) * random.random::<f64>();
        let mean: Vec<f64> = start.low.iter().zip(&start.high).map(uniform).collect();
        let (n, dim) = (mean.len(), mean.len() as f64);
        // pycma's limit: far more than a run needs while it makes progress.
        let general = (100.0 + 150.0 * (dim + 3.0) * (dim + 3.0) / sqrt(lambda as f64)) as u64;
        let sigma = start.sigma * sigma_factor;
        let mut run = CmaEs {
            n,
            start: start.clone(),
            first_sigma: sigma,
            max_generations: general.min(limit),
            lambda,
            mean: DVector::from_vec(mean),
            sigma,
            c: DMatrix::identity(n, n),
            b: DMatrix::identity(n, n),
            d: DVector::repeat(n, 1.0),
            p_sigma: DVector::zeros(n),
            p_c: DVector::zeros(n),
            generation: 0,
            history: History::default(),
            seed,
            purpose: format!("cma-es sample of run {run}"),
            samples: 0,
        };
        run.keep_min_std();
        run.decompose();
        run
    }

    /// Returns the standard deviation of coordinate `i`, in units of x.
    fn std(&self, i: usize) -> f64 {
        self.sigma * sqrt(self.c[(i, i)].max(0.0))
    }

    /// Draws one candidate, `x = m + sigma B D z` (38) to (40).
    pub fn sample(&mut self) -> Vec<f64> {
        let mut random = stream(self.seed, self.samples, &self.purpose);
        self.samples += 1;
        let scaled = self.d.map(|d| d * random.sample::<f64, _>(StandardNormal));
        (&self.mean + self.sigma * (&self.b * scaled)).as_slice().to_vec()
    }

    /// Updates the distribution from the solutions of a generation. Their number may differ from lambda; the
    /// strategy parameters are those for the actual number. Fewer than two solutions, or any solution of the
    /// wrong dimension, have no effect.
    pub fn tell(&mut self, solutions: &[Solution]) {
        if solutions.len() < 2 || solutions.iter().any(|s| s.x.len() != self.n) {
            return;
        }
        let value = |s: &Solution| if s.value.is_nan() { f64::INFINITY } else { s.value };
        let mut ranked: Vec<&Solution> = solutions.iter().collect();
        ranked.sort_by(|a, b| value(a).total_cmp(&value(b)));
        self.history.push(&ranked.iter().map(|s| value(s)).collect::<Vec<_>>());

        let p = Parameters::new(self.n, ranked.len());
        let step = |s: &&Solution| (DVector::from_column_slice(&s.x) - &self.mean) / self.sigma;
        let steps: Vec<DVector<f64>> = ranked.iter().map(step).collect();
        self.generation += 1;
        // (41) and (42) with `c_m = 1`.
        let mut mean_step = DVector::zeros(self.n);
        for (&w, y) in p.weights[..p.mu].iter().zip(&steps) {
            mean_step.axpy(w, y, 1.0);
        }
        self.mean.axpy(self.sigma, &mean_step, 1.0);
        // The evolution paths (43) and (45); `h_sigma` is whether the path of C is updated in full.
        let gain = sqrt(p.c_sigma * (2.0 - p.c_sigma) * p.mu_eff);
        self.p_sigma.axpy(gain, &self.whiten(&mean_step), 1.0 - p.c_sigma);
        let warm = sqrt(1.0 - pow(1.0 - p.c_sigma, 2.0 * self.generation as f64));
        let limit = (1.4 + 2.0 / (self.n as f64 + 1.0)) * p.chi_n;
        let h_sigma = self.p_sigma.norm() / warm < limit;
        let gain = if h_sigma { sqrt(p.c_c * (2.0 - p.c_c) * p.mu_eff) } else { 0.0 };
        self.p_c.axpy(gain, &mean_step, 1.0 - p.c_c);
        self.update_covariance(&p, &steps, h_sigma);
        // (44); the exponent is limited to 1 as in the tutorial's example code.
        let surplus = self.p_sigma.norm() / p.chi_n - 1.0;
        self.sigma *= exp((p.c_sigma / p.d_sigma * surplus).min(1.0));
        self.keep_min_std();
        self.decompose();
    }

    /// Updates C (46), (47).
    fn update_covariance(&mut self, p: &Parameters, steps: &[DVector<f64>], h_sigma: bool) {
        let weight = |(&w, y): (&f64, &DVector<f64>)| {
            let scale = || self.n as f64 / self.whiten(y).norm_squared().max(f64::MIN_POSITIVE);
            if w >= 0.0 { w } else { w * scale() }
        };
        let weights: Vec<f64> = p.weights.iter().zip(steps).map(weight).collect();
        let lost = if h_sigma { 0.0 } else { p.c_c * (2.0 - p.c_c) };
        let sum: f64 = p.weights.iter().sum();
        let keep = 1.0 + p.c_1 * lost - p.c_1 - p.c_mu * sum;
        self.c.syger(p.c_1, &self.p_c, &self.p_c, keep);
        for (w, y) in weights.iter().zip(steps) {
            self.c.syger(p.c_mu * w, y, y, 1.0);
        }
    }

    /// Returns `C^(-1/2) y = B D^-1 B^T y`.
    fn whiten(&self, y: &DVector<f64>) -> DVector<f64> {
        let along = self.b.tr_mul(y).zip_map(&self.d, |v, d| v / d.max(f64::MIN_POSITIVE));
        &self.b * along
    }

    /// Keeps every coordinate's standard deviation at or above its minimum, so that a discrete
    /// axis is never frozen on one level: the variance is raised on the diagonal of C, and
    /// sigma as a whole where all coordinates are below (C would grow without bound).
    fn keep_min_std(&mut self) {
        let least = |i: usize| self.start.min_std.get(i).copied().unwrap_or(0.0);
        let ratios = (0..self.n).filter(|&i| least(i) > 0.0).map(|i| self.std(i) / least(i));
        let ratio = ratios.fold(0.0, f64::max);
        let bounded = (0..self.n).all(|i| least(i) > 0.0);
        if bounded && ratio > 0.0 && ratio < 1.0 {
            self.sigma /= ratio;
        }
        for i in 0..self.n {
            let variance = (least(i) / self.sigma) * (least(i) / self.sigma);
            let c = &mut self.c[(i, i)];
            if *c < variance {
                *c = variance;
            }
        }
    }

    /// Decomposes C. If that fails (C is not finite, and the run ends) the last eigenvectors are kept.
    fn decompose(&mut self) {
        if self.n == 0 {
            return;
        }
        let parts = SymmetricEigen::try_new(self.c.clone(), f64::EPSILON, EIGEN_ITERATIONS);
        if let Some(parts) = parts {
            self.d = parts.eigenvalues.map(|value| sqrt(value.max(0.0)));
            self.b = parts.eigenvectors;
        }
    }

    /// Returns whether the run should end, by appendix B.3 of the tutorial.
    pub fn ended(&self) -> bool {
        if self.generation == 0 {
            return false;
        }
        let finite = self.sigma.is_finite()
            && self.sigma > 0.0
            && self.mean.iter().chain(&self.c).all(|v| v.is_finite());
        !finite
            || self.history.ended(self.n, self.lambda, &self.start.tolerances)
            || self.distribution_ended()
            || self.generation >= self.max_generations
    }

    /// Returns whether TolX, TolXUp, ConditionCov, NoEffectAxis or NoEffectCoord applies.
    fn distribution_ended(&self) -> bool {
        let (tol, mut axes) = (&self.start.tolerances, 0..self.n);
        let small = |i: usize| self.std(i) < tol.x && (self.sigma * self.p_c[i]).abs() < tol.x;
        let longest = self.d.iter().copied().fold(0.0, f64::max);
        let shortest = self.d.iter().copied().fold(f64::INFINITY, f64::min);
        // One axis per generation, in turn, as in the tutorial.
        let axis = (self.generation % self.n.max(1) as u64) as usize;
        let along = |i: usize| 0.1 * self.sigma * self.d[axis] * self.b[(i, axis)];
        axes.clone().all(small)
            || axes.clone().any(|i| self.std(i) > tol.x_up * self.first_sigma)
            || longest > sqrt(MAX_CONDITION) * shortest
            || axes.clone().all(|i| self.mean[i] == self.mean[i] + along(i))
            || axes.any(|i| self.mean[i] == self.mean[i] + 0.2 * self.std(i))
    }
}
