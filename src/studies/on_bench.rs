//! Bench prediction of the fingers of a study with measurements.

use crate::setup::bench::{CalibrationContext, folds};
use crate::setup::run::settings;
use crate::{Context, Failure, RunRequest, Setup};
use calibration::bench::Settings;
use calibration::calibrate::Calibration;
use calibration::simulation::Simulation;
use calibration::table::{self, bench_prediction, best_fingers};
use insertion::{Measure, Objectives};
use rayon::ThreadPool;
use study::{BENCH_FILE, Study, StudyConfig, write_analysis, write_own_file};

/// Table of the predictions of all fingers of the space.
const TABLE: &str = "bench_predictions.csv";

/// Checks that a study can end with a bench prediction.
pub(crate) fn check(config: &StudyConfig) -> Result<(), Failure> {
    let refused = |what: &str| {
        Err(Failure::usage(format!("--measurements predicts the range of one task; {what}")))
    };
    match (&config.objective, config.several_tasks(), config.constraints.is_empty()) {
        (_, true, _) => refused("give one --task"),
        (objective, ..) if *objective != Objectives::of(Measure::Range) => {
            refused(&format!("--objective {objective} is not measured on the bench; leave it out"))
        }
        (.., false) => refused("a --constraint is not measured on the bench; leave it out"),
        _ => Ok(()),
    }
}

/// Predicts the range of every finger of the space on the bench and stores the prediction, if there are measurements
/// and it is not stored yet.
pub(crate) fn predict(
    (study, setup): (&Study, &Setup),
    run: &RunRequest,
    pool: &ThreadPool,
    context: &Context<'_>,
) -> Result<(), Failure> {
    let wanted = setup.measured.as_ref().zip(study.config.conclusion.bench);
    let Some((measured, effort)) = wanted else { return Ok(()) };
    if study.record().on_bench.is_some_and(|found| found.effort == effort) {
        return Ok(());
    }
    let (priors, simulations) = (&measured.priors, usize::from(effort.simulations));
    let (seed, cache) = (study.config.seed, run.cache.folder(setup));
    let known = CalibrationContext { setup, priors, simulations, seed, cache, context };
    let provenance = study.provenance().clone();
    let (found, predictions) = pool.install(|| {
        let (subjects, layout) = known.subjects(&measured.file, &measured.experiments, &[])?;
        let done = folds(context);
        let settings = Settings { done: &done, ..settings(effort, known.seed, context.stop) };
        let calibration = Calibration::new(layout, &subjects, &settings);
        context.check()?;
        let nothing = || Failure::running("the space has no finger to predict");
        let task = subjects.first().zip(calibration.tasks.first());
        let (subject, result) = task.ok_or_else(nothing)?;
        let best = best_fingers(subject, result).first().copied().ok_or_else(nothing)?;
        let (task, cache) = (setup.only_task()?, known.cache.clone());
        let simulation = Simulation::new(&setup.evaluator, task, [].iter(), cache, context.stop);
        let simulated = simulation.window(&best.design, &[])?;
        context.check()?;
        let found = bench_prediction(subject, result, simulated, provenance, effort);
        Ok::<_, Failure>((found, table::predictions_csv(subject, result)))
    })?;
    write_own_file(&study.dir().join(TABLE), &predictions)?;
    Ok(write_analysis(study.dir(), BENCH_FILE, &found)?)
}
