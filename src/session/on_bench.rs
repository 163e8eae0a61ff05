//! A study with measurements: which of its fingers is the best on the bench.

use super::calibration::{Ground, folds};
use super::failure::not_stopped;
use super::how::{RunRequest, settings};
use super::{Failure, Setup, Watch, tell};
use calibration::bench::Settings;
use calibration::calibrate::Calibration;
use calibration::simulation::Simulation;
use calibration::table::{self, by_range, on_bench};
use insertion::evaluation::objective::{Measure, Objectives};
use rayon::ThreadPool;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use study::{Study, StudyConfig, write_own_file};

/// Every finger of the space as predicted, in the study's folder.
const TABLE: &str = "bench_predictions.csv";

/// Whether a study of this can end with a prediction for the bench.
pub(super) fn check(config: &StudyConfig) -> Result<(), Failure> {
    let refused = |what: &str| {
        Err(Failure::usage(format!("--measurements predicts the range of one task; {what}")))
    };
    match (&config.objective, config.several_tasks(), config.constraints.is_empty()) {
        (_, true, _) => refused("give one --task"),
        (objective, ..) if *objective != Objectives::of(Measure::Range) => {
            refused(&format!("--objective {objective} is not known on the bench; leave it out"))
        }
        (.., false) => refused("a --constraint is not known on the bench; leave it out"),
        _ => Ok(()),
    }
}

/// Predicts every finger of the space on the bench, if there are measurements and it is not known
/// yet, and keeps that with the study.
pub(super) fn predict(
    (study, setup): (&Study, &Setup),
    how: &RunRequest,
    pool: &ThreadPool,
    stop: &AtomicBool,
    watch: &mut Watch<'_>,
) -> Result<(), Failure> {
    let wanted = setup.measured.as_ref().zip(study.config.conclusion.bench);
    let Some((measured, effort)) = wanted else { return Ok(()) };
    if study.record().on_bench.is_some_and(|known| known.effort == effort) {
        return Ok(());
    }
    let ground = Ground {
        setup,
        priors: &measured.priors,
        simulations: usize::from(effort.simulations),
        seed: study.config.seed,
        cache: how.cache.folder(setup)?,
        stop,
    };
    let provenance = study.provenance().clone();
    let (found, predictions) = pool.install(|| {
        let (subjects, layout) =
            ground.subjects(&measured.file, &measured.experiments, &[], watch)?;
        let watch = Mutex::new(watch);
        let done = |[done, of]: [usize; 2]| tell(&watch, folds(done, of));
        let settings = Settings { done: &done, ..settings(effort, ground.seed, stop) };
        let calibration = Calibration::new(layout, &subjects, &settings);
        not_stopped(stop)?;
        let nothing = || Failure::running("the space has no finger to predict");
        let one = subjects.first().zip(calibration.tasks.first());
        let (subject, result) = one.ok_or_else(nothing)?;
        let best = by_range(result).first().map(|best| best.finger).ok_or_else(nothing)?;
        let (task, cache) = (setup.only_task()?, ground.cache.clone());
        let simulation = Simulation::new(&setup.evaluator, task, [].iter(), cache, stop);
        let simulated = simulation.window(&subject.designs[best], &[]).map_err(Failure::input)?;
        not_stopped(stop)?;
        let found = on_bench(subject, result, simulated, provenance, effort);
        Ok::<_, Failure>((found, table::predictions_csv(subject, result)))
    })?;
    write_own_file(&study.dir().join(TABLE), &predictions)?;
    Ok(study.keep_on_bench(&found)?)
}
