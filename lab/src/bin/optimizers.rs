//! Counts the evaluations that optimizers need on problems with known optima: prints CSV, a line for each run.
//! `scripts/peers.py` measures other libraries on the same problems.

use anyhow::{Context as _, Result, bail};
use ask_tell::cmaes::{Restarts, Solution, StartBox, Tolerances};
use ask_tell::{Grid, GridPoint, Observation, OptimizerKind, build};
use clap::Parser;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

/// Levels per axis of the grids of Branin and Hartmann.
const LEVELS: u32 = 1001;
/// Evaluations after which a run on a landscape counts as failed.
const LANDSCAPE_LIMIT: usize = 100;
/// Largest shortfall to the best design of a landscape, mm, and its rounding.
const SHORTFALL_MM: f64 = 0.1 + 1e-9;
/// Evaluations after which a run of CMA-ES counts as failed, and the value that ends it.
const CMA_LIMIT: usize = 1_000_000;
const CMA_TARGET: f64 = 1e-8;

#[derive(Parser)]
struct Arguments {
    /// sphere, rosenbrock, ellipsoid or rastrigin (CMA-ES to 1e-8 in 2-D and 5-D), branin or hartmann6 (on 1001
    /// levels per axis, to 1 % of the range), or a recorded landscape (to within 0.1 mm of its best design)
    #[arg(required = true, value_name = "FUNCTION or FILE.csv")]
    problems: Vec<String>,
    /// Optimizers, separated by commas
    #[arg(long, value_delimiter = ',', default_values_t = OptimizerKind::all())]
    optimizers: Vec<OptimizerKind>,
    /// Runs of each optimizer on each problem, with seeds from 0
    #[arg(long, default_value_t = 20)]
    seeds: u64,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    println!("problem,method,seed,evaluations");
    for problem in &arguments.problems {
        if let Some(function) = unbounded(problem) {
            for n in [2, 5] {
                let name = format!("{problem} {n}-D to 1e-8");
                arguments.report(&name, OptimizerKind::CmaEs, |seed| cma_es(function, n, seed));
            }
            continue;
        }
        for problem in GridProblem::named(problem)? {
            for &kind in &arguments.optimizers {
                arguments.report(&problem.name, kind, |seed| problem.evaluations(kind, seed));
            }
        }
    }
    Ok(())
}

impl Arguments {
    /// Prints the runs of a method on a problem: no number where the target was not reached.
    fn report(
        &self,
        name: &str,
        kind: OptimizerKind,
        run: impl Fn(u64) -> Option<usize> + Send + Sync,
    ) {
        let runs: Vec<_> = (0..self.seeds).into_par_iter().map(run).collect();
        for (seed, evaluations) in runs.into_iter().enumerate() {
            let evaluations = evaluations.map_or(String::new(), |n| n.to_string());
            println!("{name},{kind},{seed},{evaluations}");
        }
    }
}

/// Function of a grid point; none where it has no value.
type Value = Box<dyn Fn(&GridPoint) -> Option<f64> + Sync>;

/// Problem on a grid: maximisation up to a target, in a limited number of evaluations.
struct GridProblem {
    name: String,
    grid: Grid,
    value: Value,
    target: f64,
    limit: usize,
}

impl GridProblem {
    /// Returns the problems of a function, negated, or of a landscape file.
    fn named(name: &str) -> Result<Vec<Self>> {
        let on_cube = |goal: &str, dimension, function: fn(&[f64]) -> f64, target, limit| {
            let grid = Grid::new(vec![LEVELS; dimension]);
            let unit = grid.clone();
            let value = Box::new(move |point: &GridPoint| Some(-function(&unit.unit(point))));
            GridProblem { name: format!("{name} to {goal}"), grid, value, target, limit }
        };
        Ok(match name {
            "branin" => vec![
                // The largest value on the square is 308.129: 1 % of the range is 3.0773.
                on_cube("1 %", 2, branin, -0.397_887 - 3.0773, 200),
                // 1 % of the optimal value itself.
                on_cube("0.004", 2, branin, -0.397_887 - 0.003_978_87, 200),
            ],
            // Its largest value is practically 0.
            "hartmann6" => vec![on_cube("1 %", 6, hartmann6, 3.322_37 - 0.033_223_7, 60)],
            file => vec![Self::landscape(Path::new(file)).with_context(|| file.to_owned())?],
        })
    }

    /// Reads a landscape: the axes, then `range_mm` (empty if the evaluation diverged), then other columns.
    fn landscape(file: &Path) -> Result<Self> {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(file)?;
        let axes = reader.headers()?.iter().position(|name| name == "range_mm");
        let axes = axes.context("no column `range_mm`")?;
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record?;
            let at = record.iter().take(axes).map(str::parse).collect::<Result<Vec<f64>, _>>()?;
            let value = Some(&record[axes]).filter(|cell| !cell.is_empty()).map(str::parse::<f64>);
            rows.push((at, value.transpose()?));
        }
        let levels = |axis: usize| {
            let mut levels: Vec<f64> = rows.iter().map(|(at, _)| at[axis]).collect();
            levels.sort_by(f64::total_cmp);
            levels.dedup();
            levels
        };
        let levels: Vec<Vec<f64>> = (0..axes).map(levels).collect();
        let grid = Grid::new(levels.iter().map(|levels| levels.len() as u32).collect());
        let level = |(at, levels): (&f64, &Vec<f64>)| levels.partition_point(|l| l < at) as u32;
        let point = |at: &[f64]| at.iter().zip(&levels).map(level).collect::<Vec<u32>>();
        let values: BTreeMap<Vec<u32>, Option<f64>> =
            rows.iter().map(|(at, value)| (point(at), *value)).collect();
        if values.len() as u64 != grid.size() {
            bail!("{} designs for a grid of {}", values.len(), grid.size());
        }
        let best = values.values().flatten().copied().reduce(f64::max).context("no value")?;
        Ok(GridProblem {
            name: format!("{} landscape", file.file_stem().unwrap_or_default().display()),
            grid,
            value: Box::new(move |point| values.get(&point.0).copied().flatten()),
            target: best - SHORTFALL_MM,
            limit: LANDSCAPE_LIMIT,
        })
    }

    /// Returns the number of evaluations, one at a time, to the target; `None` beyond the limit.
    fn evaluations(&self, kind: OptimizerKind, seed: u64) -> Option<usize> {
        let mut optimizer = build(kind, self.grid.clone(), seed);
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

/// Returns the evaluations of BIPOP-CMA-ES to below 1e-8, from a point of [-4, 4]^n with a step size of 2.
fn cma_es(function: fn(&[f64]) -> f64, n: usize, seed: u64) -> Option<usize> {
    let start = StartBox {
        low: vec![-4.0; n],
        high: vec![4.0; n],
        sigma: 2.0,
        min_std: Vec::new(),
        max_lambda: 1 << 14,
        tolerances: Tolerances::default(),
    };
    let (mut cma, mut evaluations) = (Restarts::new(start, seed), 0);
    while evaluations < CMA_LIMIT {
        let mut population = Vec::new();
        for x in cma.ask() {
            evaluations += 1;
            let value = function(&x);
            if value < CMA_TARGET {
                return Some(evaluations);
            }
            population.push(Solution { x, value });
        }
        cma.tell(&population);
    }
    None
}

/// Returns the function of this name that CMA-ES searches off the grid; its minimum is 0.
fn unbounded(name: &str) -> Option<fn(&[f64]) -> f64> {
    Some(match name {
        "sphere" => |x| x.iter().map(|v| v * v).sum(),
        "rosenbrock" => |x| {
            x.windows(2).map(|w| 100.0 * (w[1] - w[0] * w[0]).powi(2) + (1.0 - w[0]).powi(2)).sum()
        },
        "ellipsoid" => |x| {
            let weight = |i| libm::pow(1e6, i as f64 / (x.len() - 1) as f64);
            x.iter().enumerate().map(|(i, v)| weight(i) * v * v).sum()
        },
        "rastrigin" => |x| x.iter().map(|v| v * v + 10.0 - 10.0 * libm::cos(2.0 * PI * v)).sum(),
        _ => return None,
    })
}

/// Branin on the unit square: three equal minima of 0.397887.
fn branin(u: &[f64]) -> f64 {
    let (x, y) = (15.0 * u[0] - 5.0, 15.0 * u[1]);
    let a = y - 5.1 / (4.0 * PI * PI) * x * x + 5.0 / PI * x - 6.0;
    a * a + 10.0 * (1.0 - 1.0 / (8.0 * PI)) * libm::cos(x) + 10.0
}

/// Hartmann on the unit cube: a minimum of -3.32237 and a second, nearly as deep.
fn hartmann6(u: &[f64]) -> f64 {
    const ALPHA: [f64; 4] = [1.0, 1.2, 3.0, 3.2];
    const A: [[f64; 6]; 4] = [
        [10.0, 3.0, 17.0, 3.5, 1.7, 8.0],
        [0.05, 10.0, 17.0, 0.1, 8.0, 14.0],
        [3.0, 3.5, 1.7, 10.0, 17.0, 8.0],
        [17.0, 8.0, 0.05, 10.0, 0.1, 14.0],
    ];
    const P: [[f64; 6]; 4] = [
        [0.1312, 0.1696, 0.5569, 0.0124, 0.8283, 0.5886],
        [0.2329, 0.4135, 0.8307, 0.3736, 0.1004, 0.9991],
        [0.2348, 0.1451, 0.3522, 0.2883, 0.3047, 0.6650],
        [0.4047, 0.8828, 0.8732, 0.5743, 0.1091, 0.0381],
    ];
    let term = |i: usize| -> f64 {
        let e: f64 = (0..6).map(|j| A[i][j] * (u[j] - P[i][j]).powi(2)).sum();
        ALPHA[i] * libm::exp(-e)
    };
    -(0..4).map(term).sum::<f64>()
}
