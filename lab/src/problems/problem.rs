//! Problems, and the evaluations that an optimizer takes to solve them.

use super::functions::Function;
use super::landscape::Landscape;
use ask_tell::cmaes::{Restarts, Solution, StartBox, Tolerances};
use ask_tell::{Grid, GridPoint, Observation, Optimizer};

/// Levels per axis of the grids on which the functions are searched.
const LEVELS: u32 = 1001;
/// Evaluations after which a run on a landscape counts as failed.
const LANDSCAPE_LIMIT: usize = 100;
/// Largest shortfall to the best design of a landscape, mm.
const SHORTFALL_MM: f64 = 0.1;
/// Rounding of the ranges, mm.
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
/// Value that counts as found.
const CMA_TARGET: f64 = 1e-8;
/// Dimensions of the functions.
pub(super) const CMA_DIMENSIONS: [usize; 2] = [2, 5];

/// Evaluations of BIPOP-CMA-ES to a value below 1e-8, from a uniform point of [-4, 4]^n with
/// a step size of 2.
pub(super) fn cma_evaluations(function: Function, n: usize, seed: u64) -> Option<usize> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use ask_tell::{OptimizerKind, build};

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
