//! What long runs of `gp` cost, and how near they come to minima that are known.
//!
//!     cargo run --release --example long_runs -- 1000 1 hartmann8
//!     cargo run --release --example long_runs -- 400 4 ackley2 ackley8 griewank8 levy4
//!
//! Evaluations, seeds, then functions with their dimension: ackley, griewank, hartmann (of the
//! first six coordinates), levy, michalewicz (in 5 dimensions), rastrigin, rosenbrock, shekel (in
//! 4). 1001 levels per axis, one point at a time. Regret is the median over the seeds (the worst).
//! Times are of the processor, as Linux tells it.

use ask_tell::{Grid, Observation, OptimizerKind, build};
use lab::problems::Function;
use std::f64::consts::{E, PI};
use std::process::ExitCode;

const STEPS: [usize; 10] = [60, 250, 300, 400, 600, 1000, 2000, 3000, 4000, 5000];

/// A function on the unit cube, what it is stretched to, and its minimum.
struct Problem {
    value: fn(&[f64]) -> f64,
    range: (f64, f64),
    minimum: f64,
}

fn problem(name: &str, dimension: usize) -> Option<Problem> {
    let (value, range, minimum): (fn(&[f64]) -> f64, _, _) = match name {
        "ackley" => (ackley, (-15.0, 30.0), 0.0),
        "griewank" => (griewank, (-60.0, 50.0), 0.0),
        "hartmann" if dimension >= 6 => {
            (|x| Function::Hartmann6.value(&x[..6]), (0.0, 1.0), -3.322_37)
        }
        "levy" => (levy, (-10.0, 10.0), 0.0),
        "michalewicz" if dimension == 5 => (michalewicz, (0.0, PI), -4.687_658),
        "rastrigin" => (|x| Function::Rastrigin.value(x), (-4.0, 5.0), 0.0),
        "rosenbrock" => (|x| Function::Rosenbrock.value(x), (-2.0, 2.0), 0.0),
        "shekel" if dimension == 4 => (shekel, (0.0, 10.0), -10.536_4),
        _ => return None,
    };
    Some(Problem { value, range, minimum })
}

fn ackley(x: &[f64]) -> f64 {
    let mean = |of: fn(f64) -> f64| x.iter().map(|v| of(*v)).sum::<f64>() / x.len() as f64;
    let (square, wave) = (mean(|v| v * v), mean(|v| (2.0 * PI * v).cos()));
    20.0 + E - 20.0 * (-0.2 * square.sqrt()).exp() - wave.exp()
}

fn griewank(x: &[f64]) -> f64 {
    let wave = |(i, v): (usize, &f64)| (v / (i as f64 + 1.0).sqrt()).cos();
    let bowl = x.iter().map(|v| v * v).sum::<f64>() / 4000.0;
    1.0 + bowl - x.iter().enumerate().map(wave).product::<f64>()
}

fn levy(x: &[f64]) -> f64 {
    let w: Vec<f64> = x.iter().map(|v| 1.0 + (v - 1.0) / 4.0).collect();
    let part = |w: &[f64]| (w[0] - 1.0).powi(2) * (1.0 + 10.0 * (PI * w[0] + 1.0).sin().powi(2));
    let last = w[w.len() - 1];
    (PI * w[0]).sin().powi(2)
        + w.windows(2).map(part).sum::<f64>()
        + (last - 1.0).powi(2) * (1.0 + (2.0 * PI * last).sin().powi(2))
}

fn michalewicz(x: &[f64]) -> f64 {
    let part = |(i, v): (usize, &f64)| v.sin() * ((i as f64 + 1.0) * v * v / PI).sin().powi(20);
    -x.iter().enumerate().map(part).sum::<f64>()
}

fn shekel(x: &[f64]) -> f64 {
    const WIDTH: [f64; 10] = [0.1, 0.2, 0.2, 0.4, 0.4, 0.6, 0.3, 0.7, 0.5, 0.5];
    const CENTRE: [[f64; 2]; 10] = [
        [4.0, 4.0],
        [1.0, 1.0],
        [8.0, 8.0],
        [6.0, 6.0],
        [3.0, 7.0],
        [2.0, 9.0],
        [5.0, 3.0],
        [8.0, 1.0],
        [6.0, 2.0],
        [7.0, 3.6],
    ];
    let square = |k: usize| -> f64 {
        x.iter().enumerate().map(|(i, v)| (v - centre(k, i, &CENTRE)).powi(2)).sum()
    };
    -(0..10).map(|k| 1.0 / (WIDTH[k] + square(k))).sum::<f64>()
}

/// The first two coordinates come again, but for the seventh centre, (5, 5, 3, 3).
fn centre(k: usize, axis: usize, of: &[[f64; 2]; 10]) -> f64 {
    if k == 6 { of[k][axis / 2] } else { of[k][axis % 2] }
}

/// Regrets at the steps, and processor seconds of the run and of 64 points more.
struct Run {
    regrets: Vec<f64>,
    took_s: f64,
    more_s: f64,
}

fn run(problem: &Problem, dimension: usize, evaluations: usize, seed: u64) -> Run {
    let grid = Grid::new(vec![1001; dimension]);
    let mut optimizer = build(OptimizerKind::Gp, grid.clone(), seed);
    let (low, high) = problem.range;
    let (mut best, mut regrets, begun_s) = (f64::INFINITY, Vec::new(), processor_s());
    for evaluation in 1..=evaluations {
        let Some(point) = optimizer.ask(1).pop() else { break };
        let x: Vec<f64> = grid.unit(&point).iter().map(|u| low + (high - low) * u).collect();
        let value = (problem.value)(&x);
        best = best.min(value);
        optimizer.tell(&[Observation::new(point, Some(-value))]);
        if STEPS.contains(&evaluation) {
            regrets.push(best - problem.minimum);
        }
    }
    let took_s = processor_s() - begun_s;
    optimizer.ask(64);
    Run { regrets, took_s, more_s: processor_s() - begun_s - took_s }
}

/// Processor time of this thread, s.
fn processor_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let first = text.split_whitespace().next().and_then(|n| n.parse::<f64>().ok());
    first.unwrap_or(f64::NAN) * 1e-9
}

fn row(name: &str, problem: &Problem, dimension: usize, evaluations: usize, seeds: u64) {
    let runs: Vec<Run> =
        (0..seeds).map(|seed| run(problem, dimension, evaluations, seed)).collect();
    let mut line = format!("| {name} |");
    for step in 0..STEPS.iter().filter(|step| **step <= evaluations).count() {
        let mut regrets: Vec<f64> = runs.iter().map(|run| run.regrets[step]).collect();
        regrets.sort_by(f64::total_cmp);
        let worst = regrets[regrets.len() - 1];
        line.push_str(&format!(" {:.2e} ({worst:.2e}) |", regrets[regrets.len() / 2]));
    }
    let mean = |of: fn(&Run) -> f64| runs.iter().map(of).sum::<f64>() / seeds as f64;
    println!("{line} {:.1} | {:.2} |", mean(|run| run.took_s), mean(|run| run.more_s));
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize| words.get(i).and_then(|word| word.parse::<u64>().ok());
    let (Some(evaluations), Some(seeds)) = (number(0), number(1).filter(|n| *n > 0)) else {
        eprintln!("error: give evaluations, seeds and functions: 400 4 ackley8 levy4");
        return ExitCode::from(2);
    };
    let steps: String = STEPS
        .iter()
        .filter(|step| **step as u64 <= evaluations)
        .map(|step| format!(" {step} |"))
        .collect();
    println!("| function, regret at |{steps} a run, s | 64 points more, s |");
    println!("|{}", " --- |".repeat(steps.matches('|').count() + 3));
    for word in &words[2..] {
        let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
        let dimension =
            word[letters.len()..].parse::<usize>().ok().filter(|d| (2..=20).contains(d));
        let problem =
            dimension.and_then(|dimension| Some((problem(letters, dimension)?, dimension)));
        let Some((problem, dimension)) = problem else {
            eprintln!("error: {word}: is no function with its dimension, as ackley8");
            return ExitCode::from(2);
        };
        row(word, &problem, dimension, evaluations as usize, seeds);
    }
    ExitCode::SUCCESS
}
