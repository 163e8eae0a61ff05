//! A study with measurements: which of its fingers is the best on the bench.

use super::Failure;
use super::calibrated::{EFFORT, EffortArguments, Ground, settings};
use super::measured::Measured;
use super::setup::Setup;
use super::words;
use crate::calibration::calibrate::Calibration;
use crate::calibration::on_bench::{by_range, on_bench};
use crate::calibration::simulation::Simulation;
use crate::calibration::table;
use crate::study::{
    BenchEffort, OnBench, Provenance, Study, StudyConfig, StudyRecord, write_own_file,
};
use insertion::evaluation::Evaluation;
use insertion::evaluation::objective::{Measure, Objectives};
use rayon::ThreadPool;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Every finger of the space as predicted, in the study's folder.
pub const TABLE: &str = "bench_predictions.csv";

/// Whether a study of this can end with a prediction for the bench.
pub fn check(config: &StudyConfig) -> Result<(), Failure> {
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
pub fn predict(
    study: &Study,
    setup: &Setup,
    arguments: EffortArguments,
    cache: Option<PathBuf>,
    pool: &ThreadPool,
    quiet: bool,
) -> Result<(), Failure> {
    let Some(measured) = &setup.measured else { return Ok(()) };
    let known = study.record().on_bench.map(|known| known.effort);
    let effort = arguments.or(known.unwrap_or(EFFORT));
    if known == Some(effort) {
        return Ok(());
    }
    let ground = Ground {
        setup,
        parameters: &measured.priors.parameters,
        simulations: usize::from(effort.simulations),
        seed: study.config.seed,
        cache,
        quiet,
    };
    let provenance = study.provenance().clone();
    let (found, predictions) = pool.install(|| all(&ground, measured, effort, provenance))?;
    write_own_file(&study.dir().join(TABLE), &predictions)?;
    Ok(study.keep_on_bench(&found)?)
}

/// The best fingers, and a table of all.
fn all(
    ground: &Ground<'_>,
    Measured { file, experiments, .. }: &Measured,
    effort: BenchEffort,
    provenance: Provenance,
) -> Result<(OnBench, String), Failure> {
    let (subjects, layout) = ground.subjects(file, experiments, &[])?;
    let calibration = Calibration::new(layout, &subjects, &settings(effort, ground.seed));
    let nothing = || Failure::running("the space has no finger to predict");
    let (subject, result) = subjects.first().zip(calibration.tasks.first()).ok_or_else(nothing)?;
    let best = by_range(result).first().map(|best| best.finger).ok_or_else(nothing)?;
    let Ground { setup, cache, .. } = ground;
    let simulation = Simulation::new(&setup.evaluator, setup.only_task()?, &[], cache.clone());
    let simulated = simulation.window(&subject.designs[best], None).map_err(Failure::input)?;
    let found = on_bench(subject, result, simulated, provenance, effort);
    Ok((found, table::predictions_csv(subject, result)))
}

/// What the terminal leads with.
pub fn lines(found: &OnBench) -> Vec<String> {
    let Some(best) = found.best.first() else { return Vec::new() };
    let mut lines = vec![
        format!("best on bench {}", best.design.labelled()),
        format!(
            "bench range   {:.1} mm (80 %: {:.1} to {:.1}); the best of all {} fingers with \
             probability {:.1} %",
            best.range_mm,
            best.low_mm,
            best.high_mm,
            found.fingers,
            100.0 * best.probability_best
        ),
        simulated(&found.simulated),
        format!("measured      {}", trust(found)),
    ];
    lines.extend(found.warnings.iter().map(|words| format!("warning       {words}")));
    lines
}

fn simulated(evaluation: &Evaluation) -> String {
    let range = Measure::Range.value(evaluation);
    let range = range.map_or("no range".to_owned(), |range| Measure::Range.show(range));
    let window = words::window(evaluation);
    format!("simulated     {range}; {}", window.split_once(' ').map_or("", |(_, text)| text.trim()))
}

fn trust(found: &OnBench) -> String {
    let trust = &found.trust;
    let count = found.measured;
    let Some(deviation) = trust.mean_deviation_percent else { return format!("{count} fingers") };
    let rank = trust.spearman.map_or("-".to_owned(), |rank| format!("{rank:+.2}"));
    format!(
        "{count} fingers; each predicted without it: {deviation:.1} % off, Spearman {rank}, {} of {} \
         in the interval",
        trust.inside, trust.fingers
    )
}

/// The finger that is the best on the bench; the numbers without `bench` are simulated.
pub fn recommended(record: &StudyRecord, found: &OnBench) -> Value {
    let Some(best) = found.best.first() else { return Value::Null };
    let evaluated = record.current().iter().find(|recorded| recorded.design == best.design);
    let range = Measure::Range.value(&found.simulated);
    let window = &found.simulated.window;
    json!({
        "values": best.design,
        "evaluation": evaluated.map(|recorded| recorded.index),
        "range_mm": range,
        "negative_mm": range.map(|_| window.negative_mm()),
        "positive_mm": range.map(|_| window.positive_mm()),
        "peak_force_n": Measure::PeakForce.value(&found.simulated),
        "bench": {
            "range_mm": best.range_mm,
            "low_mm": best.low_mm,
            "high_mm": best.high_mm,
            "probability_best": best.probability_best,
            "failure_negative": best.failures[0],
            "failure_positive": best.failures[1],
        },
    })
}

/// How the prediction for the bench came about, and how far it is to be trusted.
pub fn to_json(found: &OnBench) -> Value {
    json!({
        "measured": found.measured,
        "designs": found.fingers,
        "simulations": found.effort.simulations,
        "samples": found.effort.samples,
        "emulator_error_mm": found.trust.emulator_error_mm,
        "loo_mean_deviation_percent": found.trust.mean_deviation_percent,
        "loo_spearman": found.trust.spearman,
        "loo_inside": found.trust.inside,
        "loo_designs": found.trust.fingers,
        "warnings": found.warnings,
    })
}
