//! How busy workers are, by a simulated clock: batches against `--async`.
//!
//!     cargo run --release --example utilisation -- 4 64 1000 sobol 1000
//!
//! The numbers are workers; the name of an optimizer holds for those after it, before it `gp`.
//! Measurements take log-uniform times over a factor of ten; nothing is simulated but the clock.
//! To ask and to tell takes the processor time that it takes here. The function is Hartmann's in
//! six dimensions; regret is against its known minimum.

use ask_tell::GridPoint;
use ask_tell::stream::stream;
use ask_tell::{Grid, Observation, Optimizer, OptimizerKind, build};
use lab::problems::Function;
use rand::RngExt;
use std::process::ExitCode;

const MINIMUM: f64 = -3.32237;

/// Workers, mean time of a measurement in s, measurements, seeds.
const CASES: [(usize, f64, usize, u64); 3] =
    [(4, 60.0, 120, 5), (64, 60.0, 640, 3), (1000, 600.0, 3000, 1)];

/// A measurement on the clock; of its value larger is better.
#[derive(Clone)]
struct Measured {
    point: GridPoint,
    begin_s: f64,
    end_s: f64,
    value: f64,
}

struct Simulation {
    seed: u64,
    workers: usize,
    mean_s: f64,
    grid: Grid,
    optimizer: Box<dyn Optimizer + Send>,
    now_s: f64,
    /// Until when there was work for every worker, or might have been.
    cut_s: f64,
    measured: Vec<Measured>,
    thinking_s: Vec<f64>,
}

impl Simulation {
    fn new(kind: OptimizerKind, workers: usize, mean_s: f64, seed: u64) -> Self {
        let grid = Grid::new(vec![1001; 6]);
        Simulation {
            seed,
            workers,
            mean_s,
            optimizer: build(kind, grid.clone(), seed),
            grid,
            now_s: 0.0,
            cut_s: 0.0,
            measured: Vec::new(),
            thinking_s: Vec::new(),
        }
    }

    /// Tells these and asks for so many; the clock goes on meanwhile.
    fn think(&mut self, told: &[Measured], count: usize) -> Vec<GridPoint> {
        let observed = |m: &Measured| Observation::new(m.point.clone(), Some(m.value));
        let told: Vec<Observation> = told.iter().map(observed).collect();
        let begin_s = processor_s();
        if !told.is_empty() {
            self.optimizer.tell(&told);
        }
        let points = self.optimizer.ask(count);
        let took_s = processor_s() - begin_s;
        self.thinking_s.push(took_s);
        self.now_s += took_s;
        points
    }

    /// Workers begin with these now.
    fn begin(&mut self, points: Vec<GridPoint>) -> Vec<Measured> {
        let mut begun = Vec::new();
        for point in points {
            let chance: f64 = stream(self.seed, self.measured.len() as u64, "duration").random();
            // The mean of 10^chance is 9 / ln 10.
            let took_s = self.mean_s * 10f64.ln() / 9.0 * 10f64.powf(chance);
            let value = -Function::Hartmann6.value(&self.grid.unit(&point));
            let (begin_s, end_s) = (self.now_s, self.now_s + took_s);
            begun.push(Measured { point, begin_s, end_s, value });
            self.measured.push(begun[begun.len() - 1].clone());
        }
        begun
    }

    /// Batches: all workers wait for the slowest.
    fn in_batches(&mut self, budget: usize) {
        let mut batch = Vec::new();
        while self.measured.len() < budget {
            let points = self.think(&batch, self.workers);
            batch = self.begin(points);
            self.now_s = batch.iter().fold(self.now_s, |end, m| end.max(m.end_s));
            self.cut_s = self.now_s;
        }
    }

    /// One told, one asked. What ends after the last was given out is no idling.
    fn as_they_come(&mut self, budget: usize) {
        let points = self.think(&[], self.workers);
        let mut running = self.begin(points);
        while self.measured.len() < budget {
            // The earliest last.
            running.sort_by(|a, b| b.end_s.total_cmp(&a.end_s));
            let Some(first) = running.pop() else { return };
            self.now_s = self.now_s.max(first.end_s);
            let points = self.think(&[first], 1);
            self.cut_s = self.now_s;
            running.extend(self.begin(points));
        }
    }

    /// Share of the workers' time that they measured.
    fn busy(&self) -> f64 {
        let spent = |m: &Measured| (m.end_s.min(self.cut_s) - m.begin_s).max(0.0);
        self.measured.iter().map(spent).sum::<f64>() / (self.workers as f64 * self.cut_s)
    }

    /// Of the best known at that time.
    fn regret(&self, at_s: f64) -> f64 {
        let known = self.measured.iter().filter(|m| m.end_s <= at_s);
        -MINIMUM - known.map(|m| m.value).fold(0.0, f64::max)
    }

    fn end_s(&self) -> f64 {
        self.measured.iter().fold(0.0, |end, m| end.max(m.end_s))
    }
}

/// Processor time of this thread, in which the optimizer works, s; as Linux tells it.
fn processor_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let first = text.split_whitespace().next().and_then(|n| n.parse::<f64>().ok());
    first.unwrap_or(f64::NAN) * 1e-9
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Both ways over all seeds, a line each.
fn rows(kind: OptimizerKind, (workers, mean_s, budget, seeds): (usize, f64, usize, u64)) {
    type Way = fn(&mut Simulation, usize);
    let ways: [(&str, Way); 2] =
        [("batches", Simulation::in_batches), ("--async", Simulation::as_they_come)];
    let runs = ways.map(|(name, way)| {
        let run = |seed| {
            let mut simulation = Simulation::new(kind, workers, mean_s, seed);
            way(&mut simulation, budget);
            simulation
        };
        (name, (0..seeds).map(run).collect::<Vec<_>>())
    });
    // When the quicker of both had measured everything.
    let ends: Vec<f64> =
        runs[0].1.iter().zip(&runs[1].1).map(|(a, b)| a.end_s().min(b.end_s())).collect();
    for (name, runs) in &runs {
        let mean =
            |of: &dyn Fn(&Simulation) -> f64| runs.iter().map(of).sum::<f64>() / seeds as f64;
        let thinking =
            |s: &Simulation| s.thinking_s.iter().sum::<f64>() / s.thinking_s.len() as f64;
        let longest = |s: &Simulation| s.thinking_s.iter().copied().fold(0.0, f64::max);
        println!(
            "| {kind} | {workers} | {mean_s:.0} | {budget} | {seeds} | {name} | {:.1} | {:.2} | {:.3} | {:.2} | {:.4} | {:.4} |",
            100.0 * mean(&Simulation::busy),
            mean(&Simulation::end_s) / 3600.0,
            mean(&thinking),
            mean(&longest),
            median(runs.iter().map(|s| s.regret(f64::INFINITY)).collect()),
            median(runs.iter().zip(&ends).map(|(s, &at_s)| s.regret(at_s)).collect()),
        );
    }
}

fn main() -> ExitCode {
    println!(
        "| optimizer | workers | mean s | evaluations | seeds | mode | busy % | hours | thinking s | longest s | \
         regret at equal evaluations | at equal time |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    );
    let mut kind = OptimizerKind::Gp;
    for word in std::env::args().skip(1) {
        if let Ok(named) = word.parse() {
            kind = named;
            continue;
        }
        let Some(case) = CASES.into_iter().find(|case| case.0.to_string() == word) else {
            eprintln!("error: {word}: there are 4, 64 and 1000 workers, and names of optimizers");
            return ExitCode::from(2);
        };
        rows(kind, case);
    }
    ExitCode::SUCCESS
}
