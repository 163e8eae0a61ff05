//! `optimize next`: the finger to print next.

use crate::layout::wrapped;
use crate::progress::cost;
use crate::setup::bench::{BenchRequest, CalibrationRequest, Prepared, folds};
use crate::setup::measured;
use crate::setup::words::parse_at_least_0;
use crate::{Context, Failure, Output, command};
use ask_tell::stream::stream;
use calibration::bench::Settings;
use calibration::calibrate::{TaskResult, leave_one_out};
use calibration::next::{Advice, Fingers, Print, advise};
use input::shipped::Source;
use insertion::Design;
use insertion::outcome::STOP_REMEDY;
use insertion::stiffness::designs;
use report::answer::words::{design, use_now};
use serde::Serialize;

/// Fingers that may be printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Among {
    /// All fingers of the space
    Space,
    /// The 11 fingers of the publication
    Published,
}

/// Recommend the finger to print next, or to stop printing.
///
/// It is the finger whose measurement is expected to improve the final choice most, by simulation and measurements:
/// because it may be the best, or because it decides between others. In a space that varies the task
/// as well (codesign) it is a finger with a strategy; another strategy for a printed finger needs no new print. The file
/// of measurements may be empty; bench.csv and that of finger-opt.toml may be missing.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: optimize next --task ket8 --measurements bench.csv --count 2")]
pub struct Request {
    /// One task and its measurements.
    #[command(flatten)]
    pub bench: BenchRequest,
    /// Number of fingers to print at a time
    #[arg(long, value_name = "K", default_value_t = 1,
          value_parser = clap::value_parser!(u16).range(1..=100))]
    pub count: u16,
    /// Fingers that may be printed
    #[arg(long, value_enum, default_value = "space")]
    pub among: Among,
    /// Smallest expected gain of the chosen finger's range that is worth a print and its measurement, mm
    #[arg(long, value_name = "MM", default_value_t = 0.1, value_parser = |text: &str| parse_at_least_0(text, "mm"))]
    pub print_cost_mm: f64,
    /// Options of the calibration.
    #[command(flatten)]
    pub calibration: CalibrationRequest,
}

/// Result: the fingers to print next, or the advice to stop, with the state of the measurements.
#[derive(Serialize)]
pub struct Advised {
    task: String,
    /// Number of fingers with a measured range.
    measured: usize,
    /// Number of fingers predicted in turn from the measurements of the others, and of those whose 80 % interval then
    /// contains the measured range.
    loo_designs: usize,
    loo_inside: usize,
    /// Whether the predictions can be trusted within their intervals, and advice with its reason.
    reliable: bool,
    verdict: String,
    /// Fingers that were printed, but of which no range could be measured.
    not_measurable: Vec<Design>,
    /// Number of simulations with a robot stop in most insertions, and of all simulations.
    stopped_simulations: usize,
    simulations: usize,
    /// Whether the measurement file does not exist yet.
    measurements_missing: bool,
    #[serde(flatten)]
    advice: Advice,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        context.begin(self.calibration.simulations() as f64 * cost::SIMULATION);
        if self.bench.setup.tasks.len() > 1 {
            return Err(Failure::usage("give one --task"));
        }
        let published = match self.among {
            Among::Space => Vec::new(),
            Among::Published => designs()
                .iter()
                .map(|design| Design::infill(design.density_percent, design.direction_deg))
                .collect(),
        };
        let file = &self.bench.measurements;
        let missing = measured::is_missing(file);
        if missing {
            context.note(&format!("{file} does not exist: fingers are chosen by simulation alone"));
        }
        let source = match missing {
            true => Source { file: file.clone(), text: String::new() },
            false => measured::file(file)?,
        };
        let prepared = self.calibration.prepare((&self.bench, &source), &published, context)?;
        let Prepared { subjects, layout, settings } = prepared;
        let benches = layout.benches(&subjects);
        let one = subjects.first().zip(benches.first());
        let (subject, bench) = one.ok_or_else(|| Failure::usage("give one --task"))?;
        let among: Vec<usize> = match self.among {
            Among::Space => (0..subject.of_space).collect(),
            Among::Published => {
                published.iter().filter_map(|design| subject.finger(design)).collect()
            }
        };
        let failed = subject.not_measurable();
        let (designs, printed) = (&subject.designs, &subject.printed());
        let fingers = Fingers { designs, printable: &among, failed: &failed, printed };
        let posterior = layout.posterior(&benches, &settings);
        let mut random = stream(settings.seed, 0, "next");
        let (count, cost_mm) = (usize::from(self.count), self.print_cost_mm);
        let advice = advise(bench, &posterior, fingers, count, cost_mm, &mut random);
        let done = folds(context);
        let (settings, dimension) = (Settings { done: &done, ..settings }, layout.dimension());
        let left_out = leave_one_out((&benches, 0), &subject.designs, dimension, &settings);
        context.check()?;
        let left_out = TaskResult { predictions: Vec::new(), left_out };
        let accuracy = left_out.accuracy(subject.emulator.error_mm);
        let verdict = left_out.verdict();
        let [stopped_simulations, simulations] = subject.emulator.stopped();
        let value = Advised {
            task: subject.task.clone(),
            stopped_simulations,
            simulations,
            measured: subject.measured().len() - failed.len(),
            loo_designs: accuracy.fingers,
            loo_inside: accuracy.inside,
            reliable: verdict.reliable,
            verdict: verdict.text,
            not_measurable: failed.iter().map(|&number| subject.designs[number].clone()).collect(),
            measurements_missing: missing,
            advice,
        };
        Ok(Output::new(wrapped(&value.text(file, cost_mm)), value))
    }
}

/// Returns a recommended print as text; `verb` is that of a finger that has to be printed.
fn print(print: &Print, verb: &str, when: &str) -> String {
    let finger = design(&print.design);
    let gain = match print.probability_better {
        Some(_) => format!("expected gain {:.2} mm over those printed", print.gain_in_use_mm),
        None => format!("expected gain {:.2} mm", print.expected_gain_mm),
    };
    let (verb, printed) = match print.needs_print {
        true => (verb, ""),
        false => ("Measure", "   no print: this finger was printed; set the other numbers\n"),
    };
    let better = print.probability_better.map_or(String::new(), |probability| {
        let percent = 100.0 * probability;
        format!("; {percent:.0} % likely to be wider than the best measured, else keep that")
    });
    let Print { expected_mm, low_mm, high_mm, .. } = print;
    let expected = format!("{expected_mm:.1} mm (80 %: {low_mm:.1} to {high_mm:.1})");
    format!(
        "{verb} {finger}{when}: {gain}{better}\n{printed}   expected {expected}: {}\n",
        print.reason
    )
}

impl Advised {
    fn text(&self, measurements: &str, print_cost_mm: f64) -> String {
        let Advised { task, advice, .. } = self;
        let [stopped, of] = [self.stopped_simulations, self.simulations];
        let not_usable = (stopped > of / 2).then(|| {
            format!(
                "Not usable as it is: the robot stops in most insertions of {stopped} of {of} simulations. \
                 {STOP_REMEDY}; `optimize evaluate` computes a push\n"
            )
        });
        let mut text = not_usable.unwrap_or_default();
        text += &match &advice.use_now {
            Some(best) => format!("{}\n", use_now(best)),
            None => {
                let missing = format!(" ({measurements} does not exist)");
                let file = if self.measurements_missing { missing } else { String::new() };
                format!("No finger to use yet: none measured on {task}{file}\n")
            }
        };
        if self.loo_designs > 0 {
            text += &format!("predictions   {}\n", self.verdict);
        }
        if advice.stop {
            text += &format!("Stop printing: no print is expected to gain {print_cost_mm} mm\n");
        }
        for (place, next) in advice.next.iter().enumerate() {
            text += &match (place, advice.stop) {
                (0, false) => print(next, "Print", " next"),
                (0, true) => print(next, "Otherwise print", ""),
                _ => print(next, "Then print", ""),
            };
        }
        if !self.not_measurable.is_empty() {
            let fingers = self.not_measurable.iter().map(design).collect::<Vec<_>>().join("; ");
            text += &format!("printed, not measurable: {fingers}\n");
        }
        text
    }
}
