//! Runs an open study to its end: threads, Ctrl-C, progress, summary.

use super::progress::Progress;
use super::setup::{self, EngineKind, OptimizerKind, Setup};
use super::{Failure, report, summary};
use crate::study::{Cache, Ending, Runner, Simulated, Study};
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Folder of the cache unless another is named.
const CACHE: &str = "results/.cache";

/// How a study is run, as opposed to what it measures.
#[derive(Debug, Args)]
pub struct SessionArguments {
    /// Threads [default: one per processor]; changes no result
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Folder of evaluations that studies share; safe to delete [default: results/.cache]
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Measure every design anew, and keep nothing
    #[arg(long, conflicts_with = "cache")]
    no_cache: bool,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
    /// Show no progress
    #[arg(long)]
    quiet: bool,
}

/// Runs a study until its budget is spent, and reports.
pub fn run(mut study: Study, setup: &Setup, arguments: &SessionArguments) -> Result<(), Failure> {
    let config = study.config.clone();
    let kind: OptimizerKind = config.optimizer.parse().map_err(bad_config)?;
    let goals = config.goals();
    let plan = setup.plan(config.seed, |measure| goals.need(measure))?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(arguments.threads.unwrap_or(0)))
        .build()
        .map_err(|error| Failure::running(format!("cannot start the threads: {error}")))?;
    let stop = stop_on_interrupt(study.dir())?;
    let cache = arguments.cache(setup);
    let evaluator = Simulated {
        predict: |design: &_| setup.surrogate.predict(design),
        template: &setup.template,
        other_templates: &setup.other_templates,
        plan: &plan,
        rig: |task: &_| setup.rig(task),
        stop: &stop,
        cache: cache.as_ref(),
    };
    let runner = Runner { evaluator: &evaluator, goals: &goals, pool: &pool, stop: &stop };
    let mut optimizer = setup::optimizer(kind, setup, &config);
    let mut progress = Progress::new(&study, arguments.quiet);
    let ended =
        runner.run(&mut study, &mut *optimizer, &mut |recorded| progress.measured(recorded));
    progress.finish();
    if let Some(problem) = cache.as_ref().and_then(Cache::problem) {
        eprintln!("warning: evaluations are not kept for other studies: {problem}");
    }
    let ending = ended.map_err(|error| match Failure::from(error) {
        Failure::Run(error) => Failure::running(format!("{error}\n{}", resume_hint(&study))),
        bad_input => bad_input,
    })?;
    report::write(study.dir(), &study.record(), setup.surrogate.0.measurements())?;
    match ending {
        Ending::Interrupted => {
            Err(Failure::running(format!("interrupted; {}", resume_hint(&study))))
        }
        ending => {
            let known = cache.map_or(0, |cache| cache.found());
            summary::show(&study, ending, known, arguments.json)
        }
    }
}

impl SessionArguments {
    fn cache(&self, setup: &Setup) -> Option<Cache> {
        // A closed formula is faster than a file.
        let default = (setup.engine != EngineKind::Fake).then(|| PathBuf::from(CACHE));
        let dir = self.cache.clone().or(default).filter(|_| !self.no_cache)?;
        Some(Cache::new(&dir, &setup.robot, &setup.engine.settings()))
    }
}

fn bad_config(error: impl std::fmt::Display) -> Failure {
    Failure::usage(format!("study.toml: {error}"))
}

fn resume_hint(study: &Study) -> String {
    let (done, budget, dir) =
        (study.evaluations.len(), study.config.evaluations(), study.dir().display());
    format!("{done} of {budget} evaluations are safe; continue with: optimize resume {dir}")
}

/// A flag that Ctrl-C (or a polite kill) sets; a second one ends the process
/// at once, which the journal survives as well.
fn stop_on_interrupt(dir: &Path) -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let (flag, dir) = (Arc::clone(&stop), dir.display().to_string());
    let handler = move || {
        if flag.swap(true, Ordering::SeqCst) {
            eprintln!("stopped; continue with: optimize resume {dir}");
            std::process::exit(1);
        }
        eprintln!("stopping after the running trials; once more to stop at once");
    };
    ctrlc::set_handler(handler)
        .map_err(|error| Failure::running(format!("cannot watch for Ctrl-C: {error}")))?;
    Ok(stop)
}
