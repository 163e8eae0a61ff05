//! Evaluations that the optimizers need on problems with a known optimum: functions in closed form,
//! and recorded landscapes of tasks. `scripts/peers.py` measures other libraries on
//! the same problems.

mod functions;
mod landscape;
mod settled;

pub use functions::Function;
pub use landscape::Landscape;
pub use settled::{settle, settled_markdown};

use ask_tell::cmaes::{Restarts, Solution, StartBox, Tolerances};
use ask_tell::statistics::mean;
use ask_tell::{Grid, GridPoint, Observation, Optimizer, OptimizerKind, build};
use rayon::prelude::*;

/// Levels per axis of the grids on which the functions are searched.
const LEVELS: u32 = 1001;
/// Evaluations after which a run on a landscape counts as failed.
const LANDSCAPE_LIMIT: usize = 100;
/// Largest shortfall to the best design of a landscape, mm.
const SHORTFALL_MM: f64 = 0.1;
const ROUNDING_MM: f64 = 1e-9;

type Value = dyn Fn(&GridPoint) -> Option<f64> + Sync;

/// Problem on a grid: maximisation up to a target, in a limited number of evaluations.
pub struct GridProblem {
    pub name: String,
    pub grid: Grid,
    value: Box<Value>,
    target: f64,
    limit: usize,
}

impl GridProblem {
    /// Problems of a function, negated; none of a function that is searched off the grid.
    pub fn of_function(function: Function) -> Vec<Self> {
        let problem = |goal: &str, dimension, target, limit| {
            let grid = Grid::new(vec![LEVELS; dimension]);
            GridProblem {
                name: format!("{}{goal}", function.name()),
                grid: grid.clone(),
                value: Box::new(move |point| Some(-function.value(&grid.unit(point)))),
                target,
                limit,
            }
        };
        match function {
            Function::Branin => vec![
                // Largest value on the square 308.129; 1 % of the range is 3.0773.
                problem(" to 1 %", 2, -0.397_887 - 3.0773, 200),
                // A harder goal: 1 % of the optimal value itself.
                problem(" to 0.004", 2, -0.397_887 - 0.003_978_87, 200),
            ],
            // Its largest value is practically 0.
            Function::Hartmann6 => vec![problem(" to 1 %", 6, 3.322_37 - 0.033_223_7, 60)],
            _ => Vec::new(),
        }
    }

    /// Search for a design within 0.1 mm of the best of a recorded landscape.
    pub fn of_landscape(name: &str, landscape: Landscape) -> Self {
        GridProblem {
            name: format!("{name} landscape"),
            grid: landscape.grid.clone(),
            target: landscape.best() - SHORTFALL_MM - ROUNDING_MM,
            limit: LANDSCAPE_LIMIT,
            value: Box::new(move |point| landscape.value(point)),
        }
    }

    /// Number of evaluations, one at a time, to the target; `None` beyond the limit.
    pub fn evaluations(&self, optimizer: &mut dyn Optimizer) -> Option<usize> {
        for evaluation in 1..=self.limit {
            let point = optimizer.ask(1).pop()?;
            let value = (self.value)(&point);
            if value.is_some_and(|value| value >= self.target) {
                return Some(evaluation);
            }
            optimizer.tell(&[Observation::new(point, value)]);
        }
        None
    }
}

/// Evaluations after which a run of CMA-ES counts as failed.
const CMA_LIMIT: usize = 1_000_000;
const CMA_TARGET: f64 = 1e-8;
const CMA_DIMENSIONS: [usize; 2] = [2, 5];

/// Evaluations of BIPOP-CMA-ES to below 1e-8, from a point of [-4, 4]^n with a step size of 2.
fn cma_evaluations(function: Function, n: usize, seed: u64) -> Option<usize> {
    let start = StartBox {
        low: vec![-4.0; n],
        high: vec![4.0; n],
        sigma: 2.0,
        min_std: Vec::new(),
        max_lambda: 1 << 14,
        tolerances: Tolerances::default(),
    };
    let mut cma = Restarts::new(start, seed);
    let mut evaluations = 0;
    while evaluations < CMA_LIMIT {
        let mut told = Vec::new();
        for x in cma.ask() {
            evaluations += 1;
            let value = function.value(&x);
            if value < CMA_TARGET {
                return Some(evaluations);
            }
            told.push(Solution { x, value });
        }
        cma.tell(&told);
    }
    None
}

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
        mean(self.evaluations.iter().flatten().map(|&run| run as f64))
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

    #[test]
    fn a_landscape_is_found_at_the_first_design_a_step_below_its_best() {
        let text = "a,range_mm\n1,0.5\n2,\n3,1.9\n4,0.7\n5,2.0\n";
        let landscape = Landscape::parse(text, "l.csv").unwrap();
        let problem = GridProblem::of_landscape("l", landscape);
        let mut order = build(OptimizerKind::Grid, problem.grid.clone(), 0);
        let points: Vec<u32> =
            std::iter::from_fn(|| order.ask(1).pop()).map(|point| point.0[0]).collect();
        let first = points.iter().position(|&k| k == 2 || k == 4).unwrap() + 1;
        let mut again = build(OptimizerKind::Grid, problem.grid.clone(), 0);
        assert_eq!(problem.evaluations(&mut *again), Some(first));
    }

    #[test]
    fn a_spent_optimizer_has_not_found_it() {
        let landscape = Landscape::parse("a,range_mm\n1,0.5\n2,3.0\n", "l.csv").unwrap();
        let mut problem = GridProblem::of_landscape("l", landscape);
        problem.target = 4.0;
        let mut search = build(OptimizerKind::Grid, problem.grid.clone(), 0);
        assert_eq!(problem.evaluations(&mut *search), None);
    }
}
