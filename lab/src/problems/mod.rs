//! Evaluations that the optimizers need on problems with a known optimum: functions in closed form,
//! and recorded landscapes of tasks. `scripts/peers.py` measures other libraries on
//! the same problems.

mod functions;
mod landscape;
mod problem;

pub use functions::Function;
pub use landscape::Landscape;
pub use problem::GridProblem;

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

/// Evaluations to the target of one method on one problem.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Runs {
    pub problem: String,
    pub method: String,
    /// By seed, from 0; `None` where the target was not reached.
    pub evaluations: Vec<Option<usize>>,
}

impl Runs {
    pub fn reached(&self) -> usize {
        self.evaluations.iter().flatten().count()
    }

    pub fn mean(&self) -> Option<f64> {
        let sum: usize = self.evaluations.iter().flatten().sum();
        (self.reached() > 0).then(|| sum as f64 / self.reached() as f64)
    }

    /// The quartile `q` of 0 .. 4, runs that failed being worse than all others; of an even
    /// number of runs the median is the upper of the two middle ones. None for a failed run.
    pub fn quartile(&self, q: usize) -> Option<usize> {
        let mut sorted = self.evaluations.clone();
        sorted.sort_by_key(|run| run.unwrap_or(usize::MAX));
        let last = sorted.len().checked_sub(1)?;
        sorted[(sorted.len() * q / 4).min(last)]
    }
}

pub fn markdown(all: &[Runs]) -> String {
    let mut text = "| problem | method | reached | mean | lower quartile | median | upper quartile | worst |\n\
                    | --- | --- | --- | --- | --- | --- | --- | --- |\n"
        .to_owned();
    for runs in all {
        let show = |n: Option<usize>| n.map_or("-".to_owned(), |n| n.to_string());
        let mean = runs.mean().map_or("-".to_owned(), |mean| format!("{mean:.0}"));
        let [low, median, high, worst] = [1, 2, 3, 4].map(|q| show(runs.quartile(q)));
        let (done, of) = (runs.reached(), runs.evaluations.len());
        text += &format!(
            "| {} | {} | {done}/{of} | {mean} | {low} | {median} | {high} | {worst} |\n",
            runs.problem, runs.method
        );
    }
    text
}

/// CSV, a line for each run; no number of evaluations where the target was not reached.
pub fn csv(all: &[Runs]) -> String {
    let mut text = "problem,method,seed,evaluations\n".to_owned();
    for runs in all {
        for (seed, evaluations) in runs.evaluations.iter().enumerate() {
            let evaluations = evaluations.map_or(String::new(), |n| n.to_string());
            text += &format!("{},{},{seed},{evaluations}\n", runs.problem, runs.method);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_run_is_worse_than_all_others_and_no_part_of_the_mean() {
        let evaluations = vec![Some(9), None, Some(3), Some(6)];
        let runs = Runs { problem: "p".to_owned(), method: "m".to_owned(), evaluations };
        assert_eq!(runs.mean(), Some(6.0));
        assert_eq!([1, 2, 3, 4].map(|q| runs.quartile(q)), [Some(6), Some(9), None, None]);
        let all = [runs];
        assert!(markdown(&all).ends_with("| p | m | 3/4 | 6 | 6 | 9 | - | - |\n"));
        assert!(csv(&all).ends_with("\np,m,0,9\np,m,1,\np,m,2,3\np,m,3,6\n"));
        let runs = Runs { problem: String::new(), method: String::new(), evaluations: vec![] };
        assert_eq!((runs.mean(), runs.quartile(2)), (None, None));
    }
}
