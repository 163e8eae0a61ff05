//! One run of CMA-ES on R^n by ask and tell.

use super::eigen::symmetric_eigen;
use super::parameters::Parameters;
use super::stop::{History, Stop, Tolerances};
use crate::stream::{normal, stream};
use libm::{exp, pow, sqrt};

/// Largest condition number of C; above it a run ends.
const CONDITION: f64 = 1e14;

/// Where and how a run starts.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// Initial mean m.
    pub mean: Vec<f64>,
    /// Initial step size sigma, above 0.
    pub sigma: f64,
    /// Population size lambda.
    pub lambda: usize,
    /// Negative weights for the worse half.
    pub active: bool,
    /// Least standard deviation per coordinate, units of x; empty or 0 for none.
    pub min_std: Vec<f64>,
    /// When to stop.
    pub tolerances: Tolerances,
}

/// A candidate and its value, smaller is better. NaN counts as positive infinity.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// The candidate as asked.
    pub x: Vec<f64>,
    /// Its value.
    pub value: f64,
}

/// CMA-ES: **minimises**. State in the tutorial's symbols.
#[derive(Debug, Clone)]
pub struct CmaEs {
    n: usize,
    start: Start,
    parameters: Parameters,
    mean: Vec<f64>,
    sigma: f64,
    /// Covariance matrix C, row-major.
    c: Vec<f64>,
    /// Eigenvectors of C in columns, row-major.
    b: Vec<f64>,
    /// Square roots of the eigenvalues of C.
    d: Vec<f64>,
    p_sigma: Vec<f64>,
    p_c: Vec<f64>,
    generation: u64,
    history: History,
    seed: u64,
    purpose: String,
    samples: u64,
}

impl CmaEs {
    /// A run that draws its samples from the streams `(seed, sample number, purpose)`.
    pub fn new(start: Start, seed: u64, purpose: &str) -> Self {
        let n = start.mean.len();
        let identity: Vec<f64> =
            (0..n * n).map(|k| if k / n == k % n { 1.0 } else { 0.0 }).collect();
        let mut run = CmaEs {
            n,
            parameters: Parameters::new(n, start.lambda, start.active),
            mean: start.mean.clone(),
            sigma: start.sigma,
            c: identity.clone(),
            b: identity,
            d: vec![1.0; n],
            p_sigma: vec![0.0; n],
            p_c: vec![0.0; n],
            generation: 0,
            history: History::default(),
            seed,
            purpose: purpose.to_owned(),
            samples: 0,
            start,
        };
        run.keep_min_std();
        run.decompose();
        run
    }

    /// The constants in use.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The mean m of the distribution.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// The step size sigma.
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// Standard deviation of coordinate `i`, units of x.
    pub fn std(&self, i: usize) -> f64 {
        self.sigma * sqrt(self.c[i * self.n + i].max(0.0))
    }

    /// Generations told.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Draws one candidate, `x = m + sigma B D z` (38) to (40).
    pub fn sample(&mut self) -> Vec<f64> {
        let z = normals(self.n, self.seed, self.samples, &self.purpose);
        self.samples += 1;
        let scaled: Vec<f64> = z.iter().zip(&self.d).map(|(z, d)| z * d).collect();
        let row = |i: usize| -> f64 {
            self.b[i * self.n..(i + 1) * self.n].iter().zip(&scaled).map(|(b, s)| b * s).sum()
        };
        (0..self.n).map(|i| self.mean[i] + self.sigma * row(i)).collect()
    }

    /// Draws a generation of lambda candidates.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        (0..self.parameters.lambda).map(|_| self.sample()).collect()
    }

    /// Updates the distribution with a generation. A generation of another size than lambda is
    /// taken with the constants of its own size; fewer than two solutions, or one of another
    /// dimension, change nothing.
    pub fn tell(&mut self, solutions: &[Solution]) {
        if solutions.len() < 2 || solutions.iter().any(|s| s.x.len() != self.n) {
            return;
        }
        let value = |s: &Solution| if s.value.is_nan() { f64::INFINITY } else { s.value };
        let mut ranked: Vec<&Solution> = solutions.iter().collect();
        ranked.sort_by(|a, b| value(a).total_cmp(&value(b)));
        self.history.push(&ranked.iter().map(|s| value(s)).collect::<Vec<_>>());

        let p = if ranked.len() == self.parameters.lambda {
            self.parameters.clone()
        } else {
            Parameters::new(self.n, ranked.len(), self.start.active)
        };
        let steps: Vec<Vec<f64>> = ranked
            .iter()
            .map(|s| s.x.iter().zip(&self.mean).map(|(x, m)| (x - m) / self.sigma).collect())
            .collect();
        self.generation += 1;
        let mean_step = self.recombine(&p, &steps);
        let h_sigma = self.update_paths(&p, &mean_step);
        self.update_covariance(&p, &steps, h_sigma);
        // (44); the exponent is limited to 1 as in the tutorial's example code.
        let surplus = norm(&self.p_sigma) / p.chi_n - 1.0;
        self.sigma *= exp((p.c_sigma / p.d_sigma * surplus).min(1.0));
        self.keep_min_std();
        self.decompose();
    }

    /// Moves the mean (42) with `c_m = 1` and returns the step in units of sigma (41).
    fn recombine(&mut self, p: &Parameters, steps: &[Vec<f64>]) -> Vec<f64> {
        let mut mean_step = vec![0.0; self.n];
        for (w, y) in p.weights[..p.mu].iter().zip(steps) {
            mean_step.iter_mut().zip(y).for_each(|(m, y)| *m += w * y);
        }
        self.mean.iter_mut().zip(&mean_step).for_each(|(m, y)| *m += self.sigma * y);
        mean_step
    }

    /// Updates both paths (43), (45) and returns `h_sigma`.
    fn update_paths(&mut self, p: &Parameters, mean_step: &[f64]) -> bool {
        let whitened = self.whiten(mean_step);
        let gain = sqrt(p.c_sigma * (2.0 - p.c_sigma) * p.mu_eff);
        for (path, w) in self.p_sigma.iter_mut().zip(&whitened) {
            *path = (1.0 - p.c_sigma) * *path + gain * w;
        }
        let warm = sqrt(1.0 - pow(1.0 - p.c_sigma, 2.0 * self.generation as f64));
        let limit = (1.4 + 2.0 / (self.n as f64 + 1.0)) * p.chi_n;
        let h_sigma = norm(&self.p_sigma) / warm < limit;
        let gain = if h_sigma { sqrt(p.c_c * (2.0 - p.c_c) * p.mu_eff) } else { 0.0 };
        for (path, y) in self.p_c.iter_mut().zip(mean_step) {
            *path = (1.0 - p.c_c) * *path + gain * y;
        }
        h_sigma
    }

    /// Updates C (46), (47).
    fn update_covariance(&mut self, p: &Parameters, steps: &[Vec<f64>], h_sigma: bool) {
        let weights: Vec<f64> = p
            .weights
            .iter()
            .zip(steps)
            .map(|(&w, y)| {
                if w >= 0.0 {
                    return w;
                }
                let length = norm(&self.whiten(y));
                w * self.n as f64 / (length * length).max(f64::MIN_POSITIVE)
            })
            .collect();
        let lost = if h_sigma { 0.0 } else { p.c_c * (2.0 - p.c_c) };
        let sum: f64 = p.weights.iter().sum();
        let keep = 1.0 + p.c_1 * lost - p.c_1 - p.c_mu * sum;
        for i in 0..self.n {
            for j in 0..=i {
                let rank_mu: f64 = weights.iter().zip(steps).map(|(w, y)| w * y[i] * y[j]).sum();
                let c = keep * self.c[i * self.n + j]
                    + p.c_1 * self.p_c[i] * self.p_c[j]
                    + p.c_mu * rank_mu;
                self.c[i * self.n + j] = c;
                self.c[j * self.n + i] = c;
            }
        }
    }

    /// `C^(-1/2) y = B D^-1 B^T y`.
    fn whiten(&self, y: &[f64]) -> Vec<f64> {
        let n = self.n;
        let mut inner = vec![0.0; n];
        for (y, row) in y.iter().zip(self.b.chunks_exact(n.max(1))) {
            inner.iter_mut().zip(row).for_each(|(v, b)| *v += b * y);
        }
        inner.iter_mut().zip(&self.d).for_each(|(v, d)| *v /= d.max(f64::MIN_POSITIVE));
        (0..n).map(|i| (0..n).map(|j| self.b[i * n + j] * inner[j]).sum()).collect()
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
            let c = &mut self.c[i * self.n + i];
            if *c < variance {
                *c = variance;
            }
        }
    }

    fn decompose(&mut self) {
        let (values, vectors) = symmetric_eigen(&self.c, self.n);
        self.d = values.iter().map(|v| sqrt(v.max(0.0))).collect();
        self.b = vectors;
    }

    /// Why the run should end, if it should.
    pub fn stop(&self) -> Option<Stop> {
        let tol = &self.start.tolerances;
        if self.generation == 0 {
            return None;
        }
        let finite = self.sigma.is_finite() && self.sigma > 0.0;
        if !finite || !self.mean.iter().chain(&self.c).all(|v| v.is_finite()) {
            return Some(Stop::NotFinite);
        }
        if let Some(stop) = self.history.stop(self.n, self.parameters.lambda, tol) {
            return Some(stop);
        }
        if let Some(stop) = self.distribution_stop(tol) {
            return Some(stop);
        }
        let limit = tol.max_generations.is_some_and(|limit| self.generation >= limit);
        limit.then_some(Stop::MaxGenerations)
    }

    fn distribution_stop(&self, tol: &Tolerances) -> Option<Stop> {
        let axes = 0..self.n;
        let small = |i: usize| self.std(i) < tol.x && (self.sigma * self.p_c[i]).abs() < tol.x;
        if axes.clone().all(small) {
            return Some(Stop::TolX);
        }
        if axes.clone().any(|i| self.std(i) > tol.x_up * self.start.sigma) {
            return Some(Stop::TolXUp);
        }
        let longest = self.d.iter().copied().fold(0.0, f64::max);
        let shortest = self.d.iter().copied().fold(f64::INFINITY, f64::min);
        if longest > sqrt(CONDITION) * shortest {
            return Some(Stop::ConditionCov);
        }
        // One axis a generation, in turn, as the tutorial has it.
        let axis = (self.generation % self.n.max(1) as u64) as usize;
        let along = |i: usize| 0.1 * self.sigma * self.d[axis] * self.b[i * self.n + axis];
        if axes.clone().all(|i| self.mean[i] == self.mean[i] + along(i)) {
            return Some(Stop::NoEffectAxis);
        }
        let dead = axes.clone().any(|i| self.mean[i] == self.mean[i] + 0.2 * self.std(i));
        dead.then_some(Stop::NoEffectCoord)
    }
}

fn norm(v: &[f64]) -> f64 {
    sqrt(v.iter().map(|x| x * x).sum())
}

/// `n` standard normal numbers from the stream of that name.
fn normals(n: usize, seed: u64, counter: u64, purpose: &str) -> Vec<f64> {
    let mut random = stream(seed, counter, purpose);
    (0..n).map(|_| normal(&mut random)).collect()
}
