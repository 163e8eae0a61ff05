//! Restarts with growing populations: IPOP (Auger and Hansen 2005) and BIPOP (Hansen 2009).

use super::core::{CmaEs, Solution, Start};
use super::parameters::default_lambda;
use super::stop::{Stop, Tolerances};
use crate::stream::stream;
use libm::{pow, sqrt};
use rand::RngExt;

/// How the population grows from run to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strategy {
    /// Twice the population at each restart.
    Ipop,
    /// Runs of doubling population, interlaced with runs of small population and step size
    /// that together get as many evaluations.
    Bipop,
}

/// What every run starts from: a uniform point of a box, and a step size.
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
    /// Negative weights for the worse half.
    pub active: bool,
    /// The population stops doubling here.
    pub max_lambda: usize,
    /// When a run stops.
    pub tolerances: Tolerances,
}

/// A finished run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FinishedRun {
    /// Its population size.
    pub lambda: usize,
    /// Solutions told to it.
    pub evaluations: u64,
    /// Why it ended; `None` if [`Restarts::restart`] ended it.
    pub stop: Option<Stop>,
}

/// CMA-ES with restarts: **minimises**, never stops by itself.
#[derive(Debug, Clone)]
pub struct Restarts {
    strategy: Strategy,
    start: StartBox,
    seed: u64,
    current: CmaEs,
    evaluations: u64,
    small: bool,
    small_budget: u64,
    large_budget: u64,
    large_runs: i32,
    finished: Vec<FinishedRun>,
}

impl Restarts {
    /// The first run starts with the default population size.
    pub fn new(strategy: Strategy, start: StartBox, seed: u64) -> Self {
        let lambda = default_lambda(start.low.len());
        let current = begin(&start, seed, 0, Plan { lambda, sigma_factor: 1.0, limit: None });
        Restarts {
            strategy,
            start,
            seed,
            current,
            evaluations: 0,
            // The first run counts as small, so that the second doubles the population.
            small: true,
            small_budget: 0,
            large_budget: 0,
            large_runs: 0,
            finished: Vec::new(),
        }
    }

    /// The current run.
    pub fn current(&self) -> &CmaEs {
        &self.current
    }

    /// The runs that have ended, oldest first.
    pub fn finished(&self) -> &[FinishedRun] {
        &self.finished
    }

    /// Draws one candidate of the current run.
    pub fn sample(&mut self) -> Vec<f64> {
        self.current.sample()
    }

    /// Draws a generation of the current run.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        self.current.ask()
    }

    /// Tells a generation, and starts the next run if this one has a reason to stop.
    pub fn tell(&mut self, solutions: &[Solution]) {
        self.current.tell(solutions);
        self.evaluations += solutions.len() as u64;
        if let Some(stop) = self.current.stop() {
            self.end(Some(stop));
        }
    }

    /// Lets the first run start from this mean, if nothing was told to it yet.
    pub fn begin_at(&mut self, mean: Vec<f64>) {
        if self.evaluations == 0 && mean.len() == self.start.low.len() {
            self.current.begin_at(&mean);
        }
    }

    /// Ends the current run and starts the next.
    pub fn restart(&mut self) {
        self.end(None);
    }

    fn end(&mut self, stop: Option<Stop>) {
        let lambda = self.current.parameters().lambda;
        self.finished.push(FinishedRun { lambda, evaluations: self.evaluations, stop });
        if self.small {
            self.small_budget += self.evaluations;
        } else {
            self.large_budget += self.evaluations;
        }
        self.evaluations = 0;
        let run = self.finished.len() as u64;
        let plan = self.plan(run);
        self.current = begin(&self.start, self.seed, run, plan);
    }

    fn plan(&mut self, run: u64) -> Plan {
        let default = default_lambda(self.start.low.len()) as f64;
        let most = (self.start.max_lambda as f64).max(default);
        let small_is_due = self.small_budget < self.large_budget.max(1);
        self.small = self.strategy == Strategy::Bipop && small_is_due;
        if !self.small {
            self.large_runs += 1;
            let lambda = (default * pow(2.0, f64::from(self.large_runs))).min(most) as usize;
            return Plan { lambda, sigma_factor: 1.0, limit: None };
        }
        let mut random = stream(self.seed, run, "cma-es small run");
        let (u, v) = (random.random::<f64>(), random.random::<f64>());
        // Between the default and half the last large population, mostly near the default.
        let half = pow(2.0, f64::from(self.large_runs) - 1.0);
        let lambda = (default * pow(half, u * u)).clamp(2.0, most) as usize;
        let limit = Some(self.large_budget / 2 / lambda as u64);
        Plan { lambda, sigma_factor: pow(0.01, v), limit }
    }
}

/// What differs between runs.
struct Plan {
    lambda: usize,
    sigma_factor: f64,
    /// Generations, beside the general limit.
    limit: Option<u64>,
}

fn begin(start: &StartBox, seed: u64, run: u64, plan: Plan) -> CmaEs {
    let mut random = stream(seed, run, "cma-es start");
    let mean = start.low.iter().zip(&start.high);
    let mean = mean.map(|(l, h)| l + (h - l) * random.random::<f64>()).collect::<Vec<f64>>();
    let n = mean.len() as f64;
    // pycma's limit: far above what a run that still makes progress needs.
    let general = (100.0 + 150.0 * (n + 3.0) * (n + 3.0) / sqrt(plan.lambda as f64)) as u64;
    let limits = [plan.limit.map(|l| l.max(1)), start.tolerances.max_generations];
    let max_generations = limits.into_iter().flatten().fold(general, u64::min);
    let tolerances =
        Tolerances { max_generations: Some(max_generations), ..start.tolerances.clone() };
    let start = Start {
        mean,
        sigma: start.sigma * plan.sigma_factor,
        lambda: plan.lambda,
        active: start.active,
        min_std: start.min_std.clone(),
        tolerances,
    };
    CmaEs::new(start, seed, &format!("cma-es sample of run {run}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start(n: usize) -> StartBox {
        StartBox {
            low: vec![-4.0; n],
            high: vec![4.0; n],
            sigma: 2.0,
            min_std: vec![],
            active: true,
            max_lambda: 1 << 14,
            tolerances: Tolerances::default(),
        }
    }

    fn minimise(
        strategy: Strategy,
        f: fn(&[f64]) -> f64,
        generations: usize,
    ) -> (f64, Vec<FinishedRun>) {
        let mut cma = Restarts::new(strategy, start(2), 1);
        let mut best = f64::INFINITY;
        for _ in 0..generations {
            let tell: Vec<_> =
                cma.ask().into_iter().map(|x| Solution { value: f(&x), x }).collect();
            best = tell.iter().map(|s| s.value).fold(best, f64::min);
            cma.tell(&tell);
        }
        (best, cma.finished().to_vec())
    }

    #[test]
    fn the_sphere_is_minimised_and_the_run_names_why_it_ended() {
        let (best, runs) = minimise(Strategy::Ipop, |x| x.iter().map(|v| v * v).sum(), 200);
        assert!(best < 1e-10, "{best}");
        assert!(matches!(runs[0].stop, Some(Stop::TolFun | Stop::TolFunHist | Stop::TolX)));
    }

    #[test]
    fn ipop_doubles_and_bipop_shares_the_budget() {
        let (_, ipop) = minimise(Strategy::Ipop, |_| 1.0, 25);
        assert!(ipop.len() > 3, "{ipop:?}");
        assert!(ipop.windows(2).all(|w| w[1].lambda == 2 * w[0].lambda), "{ipop:?}");
        assert!(ipop.iter().all(|r| r.stop.is_some()));
        let (_, bipop) = minimise(Strategy::Bipop, |x| x[0].sin() + x[1].cos(), 2000);
        let large: Vec<usize> = bipop.iter().map(|r| r.lambda).filter(|l| *l >= 12).collect();
        assert!(large.len() >= 2 && bipop.len() > large.len(), "{bipop:?}");
    }
}
