//! Counts the prints that `optimize next` needs to find the best of the eleven published fingers on synthetic benches
//! of every task. True ranges on a bench are a linear, curved or stepped function of the stiffness; the noise of a
//! measured range is 0.1 to 0.5 mm.
//!
//! Writes two tables: `benches.csv` (a line for each bench) and `summary.csv` (means for each task and shape).

use ask_tell::normal::StandardNormal;
use ask_tell::statistics::{mean, span};
use ask_tell::stream::stream;
use calibration::bench::{Observation, sampled};
use calibration::next::{Fingers, advise};
use calibration::predict::{IntervalKind, predict};
use clap::Parser;
use finger_opt::context::Context;
use finger_opt::failure::Failure;
use finger_opt::setup::bench::{BenchRequest, CalibrationRequest, DEFAULT_PRIORS, Prepared};
use finger_opt::setup::request::{SetupRequest, TaskSource};
use finger_opt::setup::run::{CacheRequest, EffortRequest};
use input::shipped::Source;
use insertion::space::Design;
use insertion::stiffness::designs;
use insertion::trial::NEVER;
use rand::RngExt;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::PathBuf;
use study::write_file;

const TASKS: [&str; 4] = ["usb", "ket8", "ket12", "rj45"];
/// Shapes of the true ranges as functions of the stiffness, used in turn.
const SHAPES: [&str; 4] = ["linear", "curved", "linear", "step"];
/// Standard deviations of a measured range.
const NOISES_MM: [f64; 4] = [0.1, 0.2, 0.3, 0.5];
/// Number of prints after which the regret is computed: the difference between the best true range and that of a chosen
/// finger.
const REGRET_PRINTS: usize = 3;
const HEADER: &str =
    "task,shape,bench,noise_mm,spread_mm,prints_to_best,regret_printed_mm,regret_named_mm\n";

#[derive(Parser)]
struct Arguments {
    /// Numbers of the first and the last bench of each task
    #[arg(long, required = true, num_args = 2, value_names = ["FIRST", "LAST"])]
    benches: Vec<u64>,
    /// Folder of the tables
    #[arg(long)]
    out: PathBuf,
    /// Cache of the simulations
    #[arg(long)]
    cache: Option<PathBuf>,
}

/// Synthetic bench: true ranges of the fingers on a task, and noise of the measurements.
struct SyntheticBench {
    shape: &'static str,
    noise_mm: f64,
    /// In the order of the published fingers.
    ranges_mm: Vec<f64>,
}

/// Result on one bench. `prints_to_best` is 0 if the best finger was never recommended.
struct BenchResult {
    task: &'static str,
    number: u64,
    truth: SyntheticBench,
    prints_to_best: usize,
    /// Regrets after `REGRET_PRINTS` prints, mm: of the best printed finger, and of the finger with the largest
    /// expected range.
    regrets_mm: [f64; 2],
}

fn main() -> Result<(), Failure> {
    let Arguments { benches, out, cache } = Arguments::parse();
    let cache = CacheRequest { dir: cache, off: false };
    let mut found: Vec<BenchResult> = Vec::new();
    for task in TASKS {
        let prepared = prepared(task, &cache)?;
        let one = |number: u64| replay(&prepared, task, number);
        found.extend((benches[0]..=benches[1]).into_par_iter().map(one).collect::<Vec<_>>());
        eprintln!("{task}");
    }
    let table = HEADER.to_owned() + &found.iter().map(line).collect::<String>();
    write_file(&out.join("benches.csv"), &table)?;
    Ok(write_file(&out.join("summary.csv"), &summary(&found))?)
}

fn published() -> Vec<Design> {
    let infill = designs().into_iter();
    infill.map(|design| Design::infill(design.density_percent, design.direction_deg)).collect()
}

/// Returns the fingers and simulations of a task for a calibration, before any measurement.
fn prepared(task: &str, cache: &CacheRequest) -> Result<Prepared<'static>, Failure> {
    let tasks = vec![TaskSource::Named(task.to_owned())];
    let bench = BenchRequest {
        setup: SetupRequest { tasks, ..SetupRequest::default() },
        measurements: String::new(),
    };
    let calibration = CalibrationRequest {
        priors: DEFAULT_PRIORS.to_owned(),
        effort: EffortRequest::default(),
        seed: 0,
        cache: cache.clone(),
    };
    let nothing = Source { file: String::new(), text: String::new() };
    calibration.prepare((&bench, &nothing), &published(), &Context::silent(&NEVER))
}

impl SyntheticBench {
    fn new(task: &str, number: u64) -> Self {
        let mut random = stream(number, 0, &format!("bench of {task}"));
        // Two independent directions; normal components make all directions equally likely.
        let [along, across] = [0, 1].map(|_| along([0, 1].map(|_| random.sample(StandardNormal))));
        let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let (level_mm, spread_mm) = (between(4.0, 8.0), between(1.5, 4.0));
        let (middle, edge) = (between(0.2, 0.8), between(0.3, 0.7));
        let at = number as usize - 1;
        let (shape, noise_mm) = (SHAPES[at % 4], NOISES_MM[at / 4 % 4]);
        let height = |(x, y): (&f64, &f64)| match shape {
            "curved" => 0.2 * y - (x - middle).powi(2),
            "step" => 0.5 * x + f64::from(u8::from(*y > edge)) * 0.5,
            _ => *x,
        };
        let heights = scaled(along.iter().zip(&across).map(height).collect());
        // The ends of a window lie on a grid of 0.1 mm.
        let range_mm = |height: &f64| tenths(level_mm + spread_mm * (height - 0.5));
        let ranges_mm = heights.iter().map(range_mm).collect();
        SyntheticBench { shape, noise_mm, ranges_mm }
    }

    fn best_mm(&self) -> f64 {
        self.ranges_mm.iter().copied().fold(0.0, f64::max)
    }
}

/// Returns the positions, scaled to 0 .. 1, of the published fingers along a direction in the plane of compliance and
/// assembly stiffness, each scaled to 0 .. 1.
fn along([x, y]: [f64; 2]) -> Vec<f64> {
    let all = designs();
    let compliance = scaled(all.iter().map(|design| design.compliance).collect());
    let assembly = scaled(all.iter().map(|design| design.assembly).collect());
    scaled(compliance.iter().zip(&assembly).map(|(ky, kz)| x * ky + y * kz).collect())
}

/// Rounds to 0.1 mm.
fn tenths(mm: f64) -> f64 {
    (10.0 * mm).round() / 10.0
}

/// Scales values linearly to the range from 0 to 1.
fn scaled(values: Vec<f64>) -> Vec<f64> {
    let [low, high] = span(&values);
    values.iter().map(|value| (value - low) / (high - low)).collect()
}

/// Simulates print and measurement of recommended fingers until the best finger has been printed and the regrets are
/// known.
fn replay(prepared: &Prepared<'_>, task: &'static str, number: u64) -> BenchResult {
    let truth = SyntheticBench::new(task, number);
    let Prepared { subjects, layout, settings } = prepared;
    let subject = &subjects[0];
    let among: Vec<usize> =
        published().iter().filter_map(|design| subject.finger(design)).collect();
    let mut bench = layout.benches(subjects).remove(0);
    let mut noise = stream(number, 1, &format!("bench of {task}"));
    let mut printed: Vec<usize> = Vec::new();
    let mut regrets_mm = [0.0; 2];
    let mut prints_to_best = None;
    while prints_to_best.is_none() || printed.len() <= REGRET_PRINTS {
        let mut random = stream(settings.seed, 0, "next");
        let posterior =
            sampled(std::slice::from_ref(&bench), layout.dimension(), settings, &mut random);
        if printed.len() == REGRET_PRINTS {
            let best = printed.iter().map(|&at| truth.ranges_mm[at]).fold(0.0, f64::max);
            let expected = predict(&bench, &posterior, &among, IntervalKind::Truth);
            let named = (0..among.len())
                .max_by(|&a, &b| expected[a].mean_mm.total_cmp(&expected[b].mean_mm))
                .unwrap_or(0);
            regrets_mm = [best, truth.ranges_mm[named]].map(|range| truth.best_mm() - range);
            if prints_to_best.is_some() {
                break;
            }
        }
        let none = BTreeSet::new();
        let fingers =
            Fingers { designs: &subject.designs, printable: &among, failed: &none, printed: &none };
        let advice = advise(&bench, &posterior, fingers, 1, 0.1, &mut random);
        let first = advice.next.first();
        let Some(finger) = first.and_then(|print| subject.finger(&print.design)) else { break };
        let at = among.iter().position(|&one| one == finger).unwrap_or(0);
        printed.push(at);
        let normal: f64 = noise.sample(StandardNormal);
        let range_mm = tenths(truth.ranges_mm[at] + truth.noise_mm * normal).max(0.0);
        bench.observations.push(Observation { finger, range_mm, at_least: false, repeats: 1 });
        if truth.ranges_mm[at] == truth.best_mm() {
            prints_to_best = prints_to_best.or(Some(printed.len()));
        }
    }
    BenchResult { task, number, truth, prints_to_best: prints_to_best.unwrap_or(0), regrets_mm }
}

fn line(found: &BenchResult) -> String {
    let BenchResult { task, number, truth, prints_to_best, regrets_mm: [printed, named] } = found;
    let SyntheticBench { shape, noise_mm, ranges_mm } = truth;
    let spread_mm = truth.best_mm() - ranges_mm.iter().copied().fold(f64::INFINITY, f64::min);
    format!(
        "{task},{shape},{number},{noise_mm},{spread_mm:.2},{prints_to_best},{printed:.2},{named:.2}\n"
    )
}

fn summary(found: &[BenchResult]) -> String {
    let mut text =
        "task,shape,benches,prints_to_best,regret_printed_mm,regret_named_mm\n".to_owned();
    for task in TASKS.into_iter().chain(["all"]) {
        for shape in ["linear", "curved", "step"] {
            let of_task = found.iter().filter(|result| task == "all" || result.task == task);
            let own: Vec<_> = of_task.filter(|result| result.truth.shape == shape).collect();
            let means = [
                mean(own.iter().map(|result| result.prints_to_best as f64)),
                mean(own.iter().map(|result| result.regrets_mm[0])),
                mean(own.iter().map(|result| result.regrets_mm[1])),
            ];
            let [prints, printed, named] = means.map(|mean| mean.unwrap_or(0.0));
            text += &format!("{task},{shape},{},{prints:.2},{printed:.2},{named:.2}\n", own.len());
        }
    }
    text
}
