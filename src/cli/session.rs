//! Runs an open study to its end: threads, Ctrl-C, progress, summary.

use super::calibrated::EffortArguments;
use super::progress::Progress;
use super::setup::Setup;
use super::{Failure, export, film, on_bench, report, say, summary, unusable};
use crate::study::{
    Cache, Confirmer, Ending, IfChanged, Runner, Simulated, Study, StudyConfig, StudyError,
    StudyRecord,
};
use ask_tell::GridPoint;
use ask_tell::gp::DEFAULT_NOISE_FLOOR;
use ask_tell::{self, Grid, Informed, Optimizer, OptimizerKind, Polished};
use clap::Args;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::tolerance::Search;
use insertion::evaluation::uncertainty::Uncertainty;
use insertion::finger::file::is_shape;
use insertion::finger::model::FingerSource;
use insertion::space::{Design, Parameter};
use insertion::stiffness::Measurement;
use rayon::ThreadPool;
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
    /// Leave out what confirms the recommendation: the best designs walked, and repeated at their ends
    #[arg(long)]
    no_confirm: bool,
    /// Go on with a study that was measured by another program version, engine setting or input
    /// file, in a new segment; the best design is then taken from that
    #[arg(long)]
    accept_changed: bool,
    /// Where designs are measured, by the installed Python package: dask://HOST:PORT, slurm,
    /// slurm:JOBS, processes or processes:N [default: on the threads of this process]
    #[arg(long, value_name = "WHERE")]
    pub executor: Option<String>,
    #[command(flatten)]
    effort: EffortArguments,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
    /// Show no progress
    #[arg(long)]
    pub quiet: bool,
}

/// Runs a study until its budget is spent, and reports.
pub fn run(mut study: Study, setup: &Setup, arguments: &SessionArguments) -> Result<(), Failure> {
    let config = study.config.clone();
    check(&config, setup)?;
    let goals = config.goals();
    let plan = setup.plan(config.seed, |measure| goals.need(measure))?;
    let pool = arguments.pool()?;
    let stop = stop_on_interrupt(study.dir())?;
    let cache = arguments.cache(setup);
    let evaluator = Simulated {
        evaluator: &setup.evaluator,
        search: Search::default(),
        plan: &plan,
        cache: cache.as_ref(),
        stop: &stop,
    };
    let runner = Runner { evaluator: &evaluator, pool: &pool, stop: &stop };
    let mut optimizer = optimizer(setup, &config)?;
    let mut progress = Progress::new(&study, arguments.quiet);
    let ended =
        runner.run(&mut study, &mut *optimizer, &mut |recorded| progress.measured(recorded));
    progress.finish();
    if let Some(problem) = cache.as_ref().and_then(Cache::problem) {
        say(&format!("warning: evaluations are not kept for other studies: {problem}"));
    }
    let ending = ended.map_err(|error| hint(error, &study))?;
    let known = cache.as_ref().map_or(0, Cache::found);
    let record = conclude(&mut study, setup, arguments, (ending, cache.as_ref()), &pool, &stop)?;
    summary::show(study.dir(), &record, ending, known, arguments.json)?;
    unusable::check(study.dir(), &record, setup)
}

/// Confirms what is recommended and writes the report of a study that has ended so.
pub fn conclude(
    study: &mut Study,
    setup: &Setup,
    arguments: &SessionArguments,
    (ending, cache): (Ending, Option<&Cache>),
    pool: &ThreadPool,
    stop: &AtomicBool,
) -> Result<StudyRecord, Failure> {
    if ending != Ending::Interrupted && !arguments.no_confirm {
        let (evaluator, search, plan) = (&setup.evaluator, Search::Walk, &Plan::WINDOW);
        let walker = Simulated { evaluator, search, plan, cache, stop };
        let by_ribs = setup.by_ribs();
        let by_ribs = by_ribs.as_ref();
        let confirmer = Confirmer { walker: &walker, by_ribs, evaluator, pool, stop };
        confirmer.confirm(study).map_err(|error| hint(error, study))?;
    }
    study.check_journal()?;
    if ending != Ending::Interrupted && !stop.load(Ordering::SeqCst) {
        let (cache, quiet) = (arguments.cache_folder(setup), arguments.quiet || arguments.json);
        on_bench::predict(study, setup, arguments.effort, cache, pool, quiet)?;
    }
    let record = study.record();
    if ending != Ending::Interrupted && !stop.load(Ordering::SeqCst) {
        film::boundary(study.dir(), &record, setup, pool)?;
    }
    export::study::write(study.dir(), &record)?;
    report::write(study.dir(), &record, &setup.evaluator.surrogate)?;
    if ending == Ending::Interrupted || stop.load(Ordering::SeqCst) {
        return Err(Failure::running(format!("interrupted; {}", resume_hint(study))));
    }
    Ok(record)
}

/// Whether `study.toml` says what the input files say, which it was once written from.
pub fn check(config: &StudyConfig, setup: &Setup) -> Result<(), Failure> {
    let evaluator = &setup.evaluator;
    let tasks = evaluator.templates.iter().map(|template| template.task().name.as_str());
    let uncertainty = setup.uncertainty.as_ref().map(|errors| &errors.name);
    for (key, same) in [
        ("tasks", tasks.eq(config.tasks())),
        ("robot", evaluator.robot.name == config.robot),
        ("uncertainty", uncertainty == config.uncertainty.as_ref()),
        ("space", setup.space == config.space),
    ] {
        if !same {
            return Err(bad_config(format!(
                "{key}: is not what the input files in the folder say; restore the file from a copy"
            )));
        }
    }
    Ok(())
}

/// The optimizer of a study.
pub fn optimizer(
    setup: &Setup,
    config: &StudyConfig,
) -> Result<Box<dyn Optimizer + Send>, Failure> {
    let kind: OptimizerKind = config.optimizer.parse().map_err(bad_config)?;
    let grid = Grid::new(setup.space.levels());
    let measures = config.objective.measures().iter();
    let floors: Vec<f64> =
        measures.map(|&measure| noise_floor(measure, setup.uncertainty.as_ref())).collect();
    let search = ask_tell::build_for(kind, grid.clone(), config.seed, &floors);
    let search = match measured_points(setup) {
        points if kind == OptimizerKind::Gp && !points.is_empty() => {
            let own = setup.space.parameters().len() + 1;
            Box::new(Informed::new(search, own, points)) as Box<dyn Optimizer + Send>
        }
        _ => search,
    };
    Ok(match config.polish {
        0 => search,
        polish => Box::new(Polished::new(search, grid, config.budget, polish)),
    })
}

/// Of a space of printed fingers the points next to the measured ones, which have the shape of the
/// finger file: what the other numbers add to the infill is told against those.
fn measured_points(setup: &Setup) -> Vec<GridPoint> {
    let parameters = setup.space.parameters();
    let FingerSource::Computed(fingers) = &setup.evaluator.fingers else { return Vec::new() };
    if !parameters.iter().any(|parameter| is_shape(&parameter.key)) {
        return Vec::new();
    }
    let point = |measured: &Measurement| {
        let infill = Design::infill(measured.density_percent, measured.direction_deg);
        let value = |p: &Parameter| infill.get(&p.key).or_else(|| fingers.file.value(&p.key));
        parameters.iter().map(|p| Some(p.nearest(value(p)?))).collect::<Option<_>>().map(GridPoint)
    };
    setup.evaluator.surrogate.measurements().iter().filter_map(point).collect()
}

/// Standard deviation of what a measure's steps round off, in its unit: ranges have steps of
/// 0.1 mm, success rates of one trial, forces and slips none.
fn noise_floor(measure: Measure, uncertainty: Option<&Uncertainty>) -> f64 {
    match measure {
        Measure::PeakForce | Measure::Slip => 0.0,
        Measure::Range | Measure::CentredRange | Measure::RobustRange => DEFAULT_NOISE_FLOOR,
        Measure::SuccessRate => {
            let trials = uncertainty.map_or(1, |errors| errors.success.trials);
            1.0 / f64::from(trials) / 12f64.sqrt()
        }
    }
}

impl SessionArguments {
    /// What to do with a study that was measured otherwise.
    pub fn if_changed(&self) -> IfChanged {
        if self.accept_changed { IfChanged::NewSegment } else { IfChanged::Refuse }
    }

    /// The threads that measure.
    pub fn pool(&self) -> Result<ThreadPool, Failure> {
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads())
            .build()
            .map_err(|error| Failure::running(format!("cannot start the threads: {error}")))
    }

    /// How many there are; 0 for one per processor.
    pub fn threads(&self) -> usize {
        usize::from(self.threads.unwrap_or(0))
    }

    /// Where evaluations are kept for other studies, if they are.
    pub fn cache(&self, setup: &Setup) -> Option<Cache> {
        let dir = self.cache_folder(setup)?;
        Some(Cache::new(&dir, &setup.evaluator.robot, &setup.evaluator.engine.record()))
    }

    fn cache_folder(&self, setup: &Setup) -> Option<PathBuf> {
        // A closed formula is faster than a file.
        let default = setup.evaluator.engine.simulates().then(|| PathBuf::from(CACHE));
        self.cache.clone().or(default).filter(|_| !self.no_cache)
    }
}

fn bad_config(error: impl std::fmt::Display) -> Failure {
    Failure::usage(format!("study.toml: {error}"))
}

/// The failure, and how to go on after it where the journal is as it was written.
pub fn hint(error: StudyError, study: &Study) -> Failure {
    let lost = matches!(error, StudyError::Interfered { .. });
    match Failure::from(error) {
        Failure::Run(error) if !lost => {
            Failure::running(format!("{error}\n{}", resume_hint(study)))
        }
        other => other,
    }
}

/// How far a study is, and how to go on.
pub fn resume_hint(study: &Study) -> String {
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
            say(&format!("stopped; continue with: optimize resume {dir}"));
            std::process::exit(1);
        }
        say("stopping; once more to stop at once");
    };
    ctrlc::set_handler(handler)
        .map_err(|error| Failure::running(format!("cannot watch for Ctrl-C: {error}")))?;
    Ok(stop)
}
