//! Evaluations that the optimizers need on problems with a known optimum: functions in closed form,
//! and recorded landscapes of tasks. `scripts/peers.py` measures other libraries on
//! the same problems.

mod functions;
mod landscape;
mod problem;
mod runs;

pub use functions::Function;
pub use landscape::Landscape;
pub use problem::GridProblem;
pub use runs::{Runs, csv, markdown};

use ask_tell::{OptimizerKind, build};
use problem::{CMA_DIMENSIONS, cma_evaluations};
use rayon::prelude::*;

/// Runs of `methods` on a function: of CMA-ES alone in R^n to 1e-8, or of all on a grid.
pub fn on_function(function: Function, methods: &[OptimizerKind], seeds: u64) -> Vec<Runs> {
    let problems = GridProblem::of_function(function);
    if !problems.is_empty() {
        return problems.iter().flat_map(|problem| on_grid(problem, methods, seeds)).collect();
    }
    let kind = OptimizerKind::CmaEs;
    let dimensions = CMA_DIMENSIONS.iter().filter(|_| methods.contains(&kind));
    dimensions
        .map(|&n| Runs {
            problem: format!("{} {n}-D to 1e-8", function.name()),
            method: kind.name().to_owned(),
            evaluations: over_seeds(seeds, |seed| cma_evaluations(function, n, seed)),
        })
        .collect()
}

pub fn on_grid(problem: &GridProblem, methods: &[OptimizerKind], seeds: u64) -> Vec<Runs> {
    let of = |&kind: &OptimizerKind| Runs {
        problem: problem.name.clone(),
        method: kind.name().to_owned(),
        evaluations: over_seeds(seeds, |seed| {
            problem.evaluations(&mut *build(kind, problem.grid.clone(), seed))
        }),
    };
    methods.iter().map(of).collect()
}

fn over_seeds(seeds: u64, run: impl Fn(u64) -> Option<usize> + Send + Sync) -> Vec<Option<usize>> {
    (0..seeds).into_par_iter().map(run).collect()
}
