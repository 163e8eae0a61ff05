//! Time that an optimizer takes between two evaluations: `cargo bench --bench optimizers`.

use ask_tell::{Grid, Observation, Optimizer, OptimizerKind, build};
use divan::Bencher;

fn main() {
    divan::main();
}

const AXES: usize = 4;

/// An optimizer that was told the values of so many points of a Sobol sequence.
fn told(kind: OptimizerKind, count: usize) -> Box<dyn Optimizer + Send> {
    let grid = Grid::new(vec![101; AXES]);
    let points = build(OptimizerKind::Sobol, grid.clone(), 0).ask(count);
    let value = |unit: Vec<f64>| {
        let terms = unit.iter().zip(1..).map(|(u, i)| libm::sin(f64::from(i) * u) - (u - 0.4) * u);
        terms.sum::<f64>()
    };
    let observe = |point: ask_tell::GridPoint| {
        let value = value(grid.unit(&point));
        Observation::new(point, Some(value))
    };
    let mut optimizer = build(kind, grid.clone(), 0);
    optimizer.tell(&points.into_iter().map(observe).collect::<Vec<_>>());
    optimizer
}

/// Fits the Gaussian process to the points and asks for the next.
#[divan::bench(args = [50, 500, 5_000], sample_count = 5, sample_size = 1)]
fn gp_fit_and_ask(bencher: Bencher, count: usize) {
    bencher
        .with_inputs(|| told(OptimizerKind::Gp, count))
        .bench_values(|mut optimizer| optimizer.ask(1));
}

/// Asks a fitted Gaussian process for one more point.
#[divan::bench(args = [50, 500, 5_000], sample_count = 5, sample_size = 1)]
fn gp_ask(bencher: Bencher, count: usize) {
    let fitted = || {
        let mut optimizer = told(OptimizerKind::Gp, count);
        optimizer.ask(1);
        optimizer
    };
    bencher.with_inputs(fitted).bench_values(|mut optimizer| optimizer.ask(1));
}

/// Ten generations.
#[divan::bench(sample_count = 20, sample_size = 1)]
fn cma_es_ask_and_tell_10_generations(bencher: Bencher) {
    let grid = Grid::new(vec![1001; AXES]);
    bencher.with_inputs(|| build(OptimizerKind::CmaEs, grid.clone(), 0)).bench_values(
        |mut optimizer| {
            for _ in 0..10 {
                let points = optimizer.ask(8);
                let observe = |point: ask_tell::GridPoint| {
                    let value = grid.unit(&point).iter().map(|u| -(u - 0.3) * (u - 0.3)).sum();
                    Observation::new(point, Some(value))
                };
                optimizer.tell(&points.into_iter().map(observe).collect::<Vec<_>>());
            }
            optimizer
        },
    );
}
