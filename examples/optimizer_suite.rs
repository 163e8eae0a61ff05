//! Evaluations that the optimizers need on functions with known optima.
//!
//! `cargo run --release --example optimizer_suite -- [cma|gp|time|all] [seeds]` prints a Markdown
//! table; `results/reference/optimizers.md` sets it beside the peers that `scripts/peers.py`
//! measures in the same way.

use finger_opt::optimizer::cmaes::{Restarts, Solution, StartBox, Strategy, Tolerances};
use finger_opt::optimizer::gp::GpOptimizer;
use finger_opt::optimizer::{Grid, Observation, Optimizer, OptimizerKind, build};
use finger_opt::space::GridPoint;
use std::f64::consts::PI;
use std::time::Instant;

/// Evaluations after which a run of CMA-ES counts as failed.
const CMA_LIMIT: usize = 1_000_000;
/// Levels per axis of the grids.
const LEVELS: u32 = 1001;

/// A function to minimise.
type Function = fn(&[f64]) -> f64;

fn sphere(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum()
}

fn rosenbrock(x: &[f64]) -> f64 {
    x.windows(2).map(|w| 100.0 * (w[1] - w[0] * w[0]).powi(2) + (1.0 - w[0]).powi(2)).sum()
}

fn ellipsoid(x: &[f64]) -> f64 {
    let last = (x.len() - 1) as f64;
    x.iter().enumerate().map(|(i, v)| 1e6f64.powf(i as f64 / last) * v * v).sum()
}

fn rastrigin(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v + 10.0 - 10.0 * (2.0 * PI * v).cos()).sum()
}

/// Branin on the unit square; minimum 0.397887.
fn branin(u: &[f64]) -> f64 {
    let (x, y) = (15.0 * u[0] - 5.0, 15.0 * u[1]);
    let a = y - 5.1 / (4.0 * PI * PI) * x * x + 5.0 / PI * x - 6.0;
    a * a + 10.0 * (1.0 - 1.0 / (8.0 * PI)) * x.cos() + 10.0
}

/// Hartmann in six dimensions on the unit cube; minimum -3.32237.
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
        ALPHA[i] * (-e).exp()
    };
    -(0..4).map(term).sum::<f64>()
}

/// Evaluations of BIPOP-CMA-ES to a value below 1e-8.
fn cma_evaluations(f: Function, n: usize, seed: u64) -> Option<usize> {
    let start = StartBox {
        low: vec![-4.0; n],
        high: vec![4.0; n],
        sigma: 2.0,
        min_std: Vec::new(),
        active: true,
        max_lambda: 1 << 14,
        tolerances: Tolerances::default(),
    };
    let mut cma = Restarts::new(Strategy::Bipop, start, seed);
    let mut evaluations = 0;
    while evaluations < CMA_LIMIT {
        let mut told = Vec::new();
        for x in cma.ask() {
            evaluations += 1;
            let value = f(&x);
            if value < 1e-8 {
                return Some(evaluations);
            }
            told.push(Solution { x, value });
        }
        cma.tell(&told);
    }
    None
}

/// Evaluations, one at a time, of an optimizer on a fine grid to a value below `target`.
fn grid_evaluations(
    optimizer: &mut dyn Optimizer,
    grid: &Grid,
    f: Function,
    (target, limit): (f64, usize),
) -> Option<usize> {
    for evaluation in 1..=limit {
        let point = optimizer.ask(1).pop()?;
        let value = f(&grid.unit(&point));
        if value < target {
            return Some(evaluation);
        }
        optimizer.tell(&[Observation::new(point, Some(-value))]);
    }
    None
}

/// One table row; a failed run counts as above every other in the quartiles.
fn row(name: &str, runs: &[Option<usize>]) {
    let mut sorted: Vec<usize> = runs.iter().map(|r| r.unwrap_or(usize::MAX)).collect();
    sorted.sort_unstable();
    let done: Vec<usize> = runs.iter().flatten().copied().collect();
    let mean = done.iter().sum::<usize>() as f64 / done.len().max(1) as f64;
    let show = |v: usize| if v == usize::MAX { "-".to_owned() } else { v.to_string() };
    // The median of an even number of runs is the upper of the two middle ones.
    let quantile = |q: usize| show(sorted[(sorted.len() * q / 4).min(sorted.len() - 1)]);
    println!(
        "| {name} | {}/{} | {mean:.0} | {} | {} | {} | {} |",
        done.len(),
        runs.len(),
        quantile(1),
        quantile(2),
        quantile(3),
        quantile(4)
    );
}

fn header(title: &str) {
    println!("\n{title}\n");
    println!("| function | reached | mean | lower quartile | median | upper quartile | worst |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
}

fn cma(seeds: u64) {
    header("BIPOP-CMA-ES, evaluations to 1e-8, start uniform in [-4, 4], sigma 2");
    let functions: [(&str, Function); 4] = [
        ("sphere", sphere),
        ("Rosenbrock", rosenbrock),
        ("ellipsoid", ellipsoid),
        ("Rastrigin", rastrigin),
    ];
    for (name, f) in functions {
        for n in [2, 5] {
            let runs: Vec<_> = (0..seeds).map(|seed| cma_evaluations(f, n, seed)).collect();
            row(&format!("{name} {n}-D"), &runs);
        }
    }
}

fn gp(seeds: u64) {
    header("1001 levels per axis, evaluations to 1 % of the range (limit 200, Hartmann-6 60)");
    let functions: [(&str, Function, usize, (f64, usize)); 3] = [
        // Largest value on the square 308.129; 1 % of the range is 3.0773.
        ("Branin", branin, 2, (0.397_887 + 3.0773, 200)),
        // A harder goal: 1 % of the optimal value itself.
        ("Branin to 0.004", branin, 2, (0.397_887 + 0.003_978_87, 200)),
        // Largest value practically 0.
        ("Hartmann-6", hartmann6, 6, (-3.322_37 + 0.033_223_7, 60)),
    ];
    for (name, f, n, goal) in functions {
        let grid = Grid::new(vec![LEVELS; n]);
        let runs = |make: &dyn Fn(u64) -> Box<dyn Optimizer + Send>| -> Vec<Option<usize>> {
            (0..seeds).map(|s| grid_evaluations(&mut *make(s), &grid, f, goal)).collect()
        };
        let exact = |s| -> Box<dyn Optimizer + Send> {
            Box::new(GpOptimizer::with_noise_floors(grid.clone(), s, &[]))
        };
        row(&format!("{name}, gp without noise floor"), &runs(&exact));
        for kind in OptimizerKind::ALL {
            row(&format!("{name}, {kind}"), &runs(&|s| build(kind, grid.clone(), s)));
        }
    }
}

/// Processor seconds this process has used, where the system tells (Linux); else wall seconds.
/// Other programs on the machine would show in wall time.
fn seconds(start: Instant) -> f64 {
    let text = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    let nanoseconds = text.split_whitespace().next().and_then(|n| n.parse::<f64>().ok());
    nanoseconds.map_or_else(|| start.elapsed().as_secs_f64(), |n| n * 1e-9)
}

/// Milliseconds of `ask` and `tell` together for the Gaussian process near 200 evaluations.
fn time() {
    println!("\nProcessor milliseconds per suggestion of `gp`, evaluations 191 to 210\n");
    println!("| grid | mean | worst |\n| --- | --- | --- |");
    let origin = Instant::now();
    for levels in [vec![21, 41], vec![101, 101], vec![141, 141], vec![1001; 2], vec![1001; 6]] {
        let grid = Grid::new(levels.clone());
        let mut optimizer = GpOptimizer::new(grid.clone(), 0);
        let mut times = Vec::new();
        for evaluation in 1..=210 {
            let started = seconds(origin);
            let points: Vec<GridPoint> = optimizer.ask(1);
            let asked = seconds(origin) - started;
            let value = |p: &GridPoint| {
                let unit = grid.unit(p);
                if unit.len() == 2 { -branin(&unit) / 30.0 } else { -hartmann6(&unit) }
            };
            let told: Vec<_> = points
                .into_iter()
                .map(|point| {
                    let value = value(&point);
                    Observation::new(point, Some(value))
                })
                .collect();
            let started = seconds(origin);
            optimizer.tell(&told);
            if evaluation > 190 {
                times.push((asked + seconds(origin) - started) * 1e3);
            }
        }
        let mean = times.iter().sum::<f64>() / times.len() as f64;
        let worst = times.iter().copied().fold(0.0, f64::max);
        println!("| {levels:?} | {mean:.1} | {worst:.1} |");
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let part = arguments.first().map_or("all", String::as_str);
    let seeds = arguments.get(1).and_then(|s| s.parse().ok()).unwrap_or(20);
    if matches!(part, "cma" | "all") {
        cma(seeds);
    }
    if matches!(part, "gp" | "all") {
        gp(seeds);
    }
    if matches!(part, "time" | "all") {
        time();
    }
}
