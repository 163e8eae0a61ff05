//! CMA-ES with restarts against recorded runs.

use ask_tell::cmaes::{Restarts, Solution, StartBox, Tolerances};
use std::f64::consts::PI;

/// Recorded runs of the optimizers: problem, method, seed, evaluations.
const RUNS: &str = include_str!("../../../results/reference/optimizers/ours.csv");

fn rastrigin(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v + 10.0 - 10.0 * libm::cos(2.0 * PI * v)).sum()
}

/// Returns the number of evaluations in two dimensions to a value below 1e-8.
fn evaluations(seed: u64) -> usize {
    let start = StartBox {
        low: vec![-4.0; 2],
        high: vec![4.0; 2],
        sigma: 2.0,
        min_std: Vec::new(),
        max_lambda: 1 << 14,
        tolerances: Tolerances::default(),
    };
    let (mut restarts, mut evaluations) = (Restarts::new(start, seed), 0);
    loop {
        let mut population = Vec::new();
        for x in restarts.ask() {
            evaluations += 1;
            let value = rastrigin(&x);
            if value < 1e-8 {
                return evaluations;
            }
            population.push(Solution { x, value });
        }
        restarts.tell(&population);
    }
}

#[test]
fn the_recorded_runs_on_rastrigin_are_repeated_exactly() {
    for seed in 0..20 {
        let run = format!("rastrigin 2-D to 1e-8,cma-es,{seed},");
        let recorded = RUNS.lines().find_map(|line| line.strip_prefix(&run));
        assert_eq!(recorded, Some(&*evaluations(seed).to_string()), "{run}");
    }
}
