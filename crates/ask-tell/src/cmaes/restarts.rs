//! Restarts with growing populations: BIPOP (Hansen 2009).

use super::core::{CmaEs, RunSettings, Solution, StartBox};
use super::parameters::default_lambda;
use crate::stream::stream;
use libm::pow;
use rand::RngExt;

/// CMA-ES with restarts: **minimises**, never stops by itself. Runs with doubled populations alternate with runs of
/// small population and step size such that both kinds get about as many evaluations.
#[derive(Debug, Clone)]
pub struct Restarts {
    start: StartBox,
    seed: u64,
    pub(super) current: CmaEs,
    /// Evaluations of the current run.
    evaluations: u64,
    /// Whether the current run counts as small.
    small: bool,
    /// Evaluations of all small runs that have ended.
    small_budget: u64,
    /// Evaluations of all large runs that have ended.
    large_budget: u64,
    large_runs: i32,
    /// Number of runs that have ended.
    runs: u64,
}

impl Restarts {
    /// Starts the first run, with the default population size.
    pub fn new(start: StartBox, seed: u64) -> Self {
        let lambda = default_lambda(start.low.len());
        let settings = RunSettings { lambda, sigma_factor: 1.0, limit: u64::MAX };
        Restarts {
            current: CmaEs::new(&start, seed, 0, settings),
            start,
            seed,
            evaluations: 0,
            // The first run counts as small, so that the second doubles the population.
            small: true,
            small_budget: 0,
            large_budget: 0,
            large_runs: 0,
            runs: 0,
        }
    }

    /// Draws a generation of the current run.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        (0..self.current.lambda).map(|_| self.current.sample()).collect()
    }

    /// Updates the current run with a generation, and starts the next run if a termination criterion applies.
    pub fn tell(&mut self, solutions: &[Solution]) {
        self.current.tell(solutions);
        self.evaluations += solutions.len() as u64;
        if self.current.ended() {
            self.restart();
        }
    }

    /// Ends the current run and starts the next.
    pub(super) fn restart(&mut self) {
        let budget = if self.small { &mut self.small_budget } else { &mut self.large_budget };
        *budget += std::mem::take(&mut self.evaluations);
        self.runs += 1;
        let settings = self.next_settings();
        self.current = CmaEs::new(&self.start, self.seed, self.runs, settings);
    }

    /// Returns the settings of the next run.
    fn next_settings(&mut self) -> RunSettings {
        let default = default_lambda(self.start.low.len()) as f64;
        let most = (self.start.max_lambda as f64).max(default);
        self.small = self.small_budget < self.large_budget.max(1);
        if !self.small {
            self.large_runs += 1;
            let lambda = (default * pow(2.0, f64::from(self.large_runs))).min(most) as usize;
            return RunSettings { lambda, sigma_factor: 1.0, limit: u64::MAX };
        }
        let mut random = stream(self.seed, self.runs, "cma-es small run");
        let (u, v) = (random.random::<f64>(), random.random::<f64>());
        // Between the default and half the last large population, mostly near the default.
        let half = pow(2.0, f64::from(self.large_runs) - 1.0);
        let lambda = (default * pow(half, u * u)).clamp(2.0, most) as usize;
        let limit = (self.large_budget / 2 / lambda as u64).max(1);
        RunSettings { lambda, sigma_factor: pow(0.01, v), limit }
    }
}

#[cfg(test)]
mod tests {
    use super::super::stop::Tolerances;
    use super::*;

    #[test]
    fn large_populations_double_and_share_the_budget_with_small_ones() {
        let start = StartBox {
            low: vec![-4.0; 2],
            high: vec![4.0; 2],
            sigma: 2.0,
            min_std: vec![],
            max_lambda: 1 << 14,
            tolerances: Tolerances::default(),
        };
        let mut cma = Restarts::new(start, 1);
        // Populations of all runs but the last.
        let mut runs = Vec::new();
        for _ in 0..2000 {
            let value = |x: &[f64]| libm::sin(x[0]) + libm::cos(x[1]);
            let tell: Vec<_> =
                cma.ask().into_iter().map(|x| Solution { value: value(&x), x }).collect();
            cma.tell(&tell);
            if cma.runs > runs.len() as u64 {
                runs.push(tell.len());
            }
        }
        let large: Vec<usize> = runs.iter().copied().filter(|l| *l >= 12).collect();
        assert!(large.len() >= 2 && runs.len() > large.len(), "{runs:?}");
        assert!(large.windows(2).any(|pair| pair[1] == 2 * pair[0]), "{runs:?}");
    }
}
