//! `optimize --task T --budget N`: begins or continues a study.

use super::arguments::{RunArguments, SetupArguments};
use super::progress::Progress;
use super::{Failure, say, summary};
use crate::session::{BATCHES, BUDGETS, Ended, OpenStudy, POLISHES, SEEDS, StudyRequest};
use ask_tell::OptimizerKind;
use clap::Args;
use insertion::evaluation::objective::{AggregateKind, Constraint, Objectives};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Run a study.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    setup: SetupArguments,
    /// Evaluations in all; run the same command with a larger one to go on
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(BUDGETS))]
    budget: u64,
    /// Then up to N evaluations more, by Nelder-Mead from the best design; the budget of
    /// such a study cannot be raised
    #[arg(long, value_name = "N", num_args = 0..=1, default_value_t = 0, default_missing_value = "20",
          allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(POLISHES))]
    polish: u64,
    /// Optimizer: gp, cma-es, random, sobol or grid
    #[arg(long, value_name = "NAME", default_value = "gp")]
    optimizer: OptimizerKind,
    /// What is optimized: range, centred-range, success-rate, robust-range, peak-force or slip;
    /// two or three, by commas, give a front
    #[arg(long, value_name = "NAME", default_value = "range")]
    objective: Objectives,
    /// What a design must keep to, as in 'peak-force<=30' or 'success-rate>=0.9'; may be given
    /// several times
    #[arg(long, value_name = "LIMIT")]
    constraint: Vec<Constraint>,
    /// Errors for success-rate and robust-range: typical, or the path of a file [default: typical]
    #[arg(long, value_name = "NAME")]
    uncertainty: Option<String>,
    /// What was measured on the bench, published or the path of a file: the study then ends with
    /// the finger that is best there, predicted from all simulations and these measurements
    #[arg(long, value_name = "FILE")]
    measurements: Option<String>,
    /// What is made of the values of several tasks [default: min]
    #[arg(long, value_enum)]
    aggregate: Option<AggregateKind>,
    /// Weight of each task, by commas, for --aggregate weighted
    #[arg(long, value_name = "W,W..", value_delimiter = ',', allow_negative_numbers = true)]
    weights: Vec<f64>,
    /// Seed; the same seed gives the same study
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 0,
          value_parser = clap::value_parser!(u64).range(SEEDS))]
    seed: u64,
    /// Designs proposed and evaluated at a time; part of the study, unlike --threads [default: that
    /// of the study if it goes on, else 4, with --executor the number of its workers]
    #[arg(long, value_name = "N", allow_negative_numbers = true,
          value_parser = clap::value_parser!(u64).range(BATCHES))]
    batch: Option<u64>,
    /// Tell each result as it comes and ask for one more design, so that no worker waits for the
    /// slowest of a batch; the journal then depends on who was fast
    #[arg(long = "async")]
    asynchronous: bool,
    /// Folder of the study.
    #[arg(
        long,
        value_name = "DIR",
        help = "Folder of the study [default: results/<task>-<optimizer>-seed<seed>]"
    )]
    out: Option<PathBuf>,
    #[command(flatten)]
    pub run: RunArguments,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    to_its_end(arguments.request().open(None)?, &arguments.run)
}

impl Arguments {
    /// What is asked for.
    pub fn request(&self) -> StudyRequest {
        StudyRequest {
            polish: self.polish,
            optimizer: self.optimizer,
            objective: self.objective.clone(),
            constraints: self.constraint.clone(),
            uncertainty: self.uncertainty.clone(),
            measurements: self.measurements.clone(),
            aggregate: self.aggregate,
            weights: self.weights.clone(),
            seed: self.seed,
            batch: self.batch,
            asynchronous: self.asynchronous,
            out: self.out.clone(),
            run: self.run.request(),
            ..StudyRequest::new(self.setup.request(), self.budget)
        }
    }
}

/// Runs an open study until its budget is spent, shows how far it is, and prints its result.
pub fn to_its_end(open: OpenStudy, arguments: &RunArguments) -> Result<(), Failure> {
    let stop = stop_on_interrupt(open.study().dir())?;
    let mut progress = Progress::new(open.study(), arguments.quiet, arguments.json);
    let Ended { dir, record, ending, known, unusable } =
        open.run(&stop, &mut |event| progress.see(event))?;
    summary::show(&dir, &record, ending, known, arguments.json)?;
    unusable.map_or(Ok(()), Err)
}

/// How long a study may take to end by itself once it is told to stop.
const GRACE: Duration = Duration::from_millis(400);

/// A flag that Ctrl-C (or a polite kill) sets. What has not looked at it in time is given up: the
/// journal survives that.
fn stop_on_interrupt(dir: &Path) -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let (flag, dir) = (Arc::clone(&stop), dir.display().to_string());
    let handler = move || {
        flag.store(true, Ordering::SeqCst);
        std::thread::sleep(GRACE);
        say(&format!("stopped; continue with: optimize resume {dir}"));
        std::process::exit(1);
    };
    ctrlc::set_handler(handler)
        .map_err(|error| Failure::running(format!("cannot watch for Ctrl-C: {error}")))?;
    Ok(stop)
}
