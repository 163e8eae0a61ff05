//! Output of a calibration: JSON, CSV, and the prediction stored in a study.

use super::calibrate::{Calibration, Coordinate, LeftOut, Prediction, TaskResult};
use super::subject::Subject;
use crate::experiments::Experiment;
use ask_tell::statistics::{Moments, normal_cdf, pearson, quantile, sorted};
use insertion::{DENSITY_KEY, DIRECTION_KEY, Design, Evaluation};
use parameters::{Path, Transform};
use serde::Serialize;
use serde_json::{Value, json};
use study::{BenchEffort, BenchFinger, BenchPrediction, Provenance};

/// Posterior standard deviation of a coordinate below which, and magnitude of its mean above which, the measurements
/// are informative about it (prior: 1 and 0).
const MOVED: (f64, f64) = (0.75, 0.5);
/// Magnitude of the posterior correlation above which two parameters are confounded.
const CONFOUNDED: f64 = 0.5;

/// Effect of the measurements on a parameter: the 10th, 50th and 90th percentile of prior and posterior, in the unit of
/// the parameter: that of the path, or none for a factor.
#[derive(Debug, Clone, Serialize)]
pub struct ParameterUpdate {
    pub name: String,
    pub task: Option<String>,
    /// Path of the number that it sets.
    #[serde(rename = "sets")]
    pub path: Path,
    /// Operation on the number.
    #[serde(rename = "as")]
    pub transform: Transform,
    pub prior_low: f64,
    pub prior_median: f64,
    pub prior_high: f64,
    pub posterior_low: f64,
    pub posterior_median: f64,
    pub posterior_high: f64,
    /// Whether the measurements shifted or narrowed its distribution considerably.
    pub moved: bool,
}

/// Returns the effect of the measurements on each parameter.
pub fn updates(calibration: &Calibration) -> Vec<ParameterUpdate> {
    let one = |(i, Coordinate { parameter, task }): (usize, &Coordinate)| {
        let values = sorted(coordinate(calibration, i));
        let moments = Moments::of(coordinate(calibration, i));
        let before = |level: f64| parameter.at(level);
        let after = |level: f64| parameter.at(normal_cdf(quantile(&values, level).unwrap_or(0.0)));
        ParameterUpdate {
            name: parameter.name.clone(),
            task: task.clone(),
            path: parameter.path.clone(),
            transform: parameter.transform,
            prior_low: before(0.1),
            prior_median: before(0.5),
            prior_high: before(0.9),
            posterior_low: after(0.1),
            posterior_median: after(0.5),
            posterior_high: after(0.9),
            moved: moments.deviation() < MOVED.0 || moments.mean.abs() > MOVED.1,
        }
    };
    calibration.layout.coordinates.iter().enumerate().map(one).collect()
}

fn coordinate(calibration: &Calibration, i: usize) -> Vec<f64> {
    calibration.posterior.iter().map(|state| state[i]).collect()
}

/// Two confounded parameters: the measurements determine a combination of them only.
#[derive(Debug, Clone, Serialize)]
pub struct Confounded {
    /// Names of the parameters.
    pub parameters: [String; 2],
    /// Correlation of their posterior samples.
    pub correlation: f64,
}

/// Returns the pairs of confounded parameters.
pub fn confounded(calibration: &Calibration) -> Vec<Confounded> {
    let names = &calibration.layout.coordinates;
    let pairs = (0..names.len()).flat_map(|i| (0..i).map(move |j| [j, i]));
    let of = |pair: [usize; 2]| {
        let [a, b] = pair.map(|i| coordinate(calibration, i));
        let parameters = pair.map(|i| names[i].parameter.name.clone());
        Confounded { parameters, correlation: pearson(&a, &b).unwrap_or(0.0) }
    };
    pairs.map(of).filter(|pair| pair.correlation.abs() > CONFOUNDED).collect()
}

/// Returns a warning if the emulator of a task is inaccurate.
pub fn warning(subject: &Subject) -> Option<String> {
    let error_mm = subject.emulator.error_mm;
    (error_mm > 0.2 * subject.emulator.mean_mm.max(1.0)).then(|| {
        format!(
            "the emulator misses fresh simulations by {error_mm:.1} mm, more than a fifth of their mean: the \
             predictions rest on the measurements; more --simulations may help"
        )
    })
}

/// Returns the output of `--json` of a calibration of these subjects.
pub fn json(calibration: &Calibration, subjects: &[Subject]) -> Value {
    let task = |(subject, result): (&Subject, &TaskResult)| {
        let emulator = &subject.emulator;
        let accuracy = result.accuracy(emulator.error_mm);
        let verdict = result.verdict();
        let inside = || 100.0 * accuracy.inside as f64 / accuracy.fingers as f64;
        json!({
            "task": subject.task,
            "designs": accuracy.fingers,
            "reliable": verdict.reliable,
            "verdict": verdict.text,
            "loo_mean_deviation_percent": accuracy.mean_deviation_percent,
            "loo_mean_of_others_percent": result.mean_of_others_percent(),
            "loo_spearman": accuracy.spearman,
            "loo_coverage_80_percent": (accuracy.fingers > 0).then(inside),
            "simulations": emulator.simulations,
            "fresh_simulations": emulator.held_out,
            "emulator_error_mm": emulator.error_mm,
            "warnings": Vec::from_iter(warning(subject)),
            "leave_one_out": result.left_out,
            "predictions": result.predictions,
        })
    };
    json!({
        "tasks": subjects.iter().zip(&calibration.tasks).map(task).collect::<Vec<_>>(),
        "parameters": updates(calibration),
        "not_told_apart": confounded(calibration),
    })
}

/// Returns `predictions.csv` of one task: a line per finger of the space.
pub fn predictions_csv(subject: &Subject, result: &TaskResult) -> String {
    let keys = subject.designs.iter().take(1).flat_map(|design| design.0.keys());
    let keys: Vec<&str> = keys.map(String::as_str).collect();
    let mut text = format!(
        "task,{},range_mm,low_mm,high_mm,probability_best,simulated_mm,failure_negative,failure_positive\n",
        keys.join(",")
    );
    for one in &result.predictions {
        let Prediction { range_mm, low_mm, high_mm, probability_best, simulated_mm, .. } = one;
        let values: Vec<String> = keys.iter().map(|key| one.design.0[*key].to_string()).collect();
        let [below, above] = [one.failure_negative, one.failure_positive]
            .map(|end| end.map_or(String::new(), |class| class.number().to_string()));
        text += &format!(
            "{},{},{range_mm:.3},{low_mm:.3},{high_mm:.3},{probability_best:.4},{simulated_mm:.3},{below},{above}\n",
            subject.task,
            values.join(",")
        );
    }
    text
}

/// Returns `leave_one_out.csv`: each measured finger with its leave-one-out prediction.
pub fn left_out_csv(calibration: &Calibration, subjects: &[Subject]) -> String {
    let head =
        format!("task,{DENSITY_KEY},{DIRECTION_KEY},measured_mm,range_mm,low_mm,high_mm,inside\n");
    let line = |subject: &Subject, one: &LeftOut| {
        let LeftOut { design, measured_mm, range_mm, low_mm, high_mm } = one;
        let [density, direction] = [DENSITY_KEY, DIRECTION_KEY]
            .map(|key| design.get(key).map_or(String::new(), |value| value.to_string()));
        format!(
            "{},{density},{direction},{measured_mm:.2},{range_mm:.3},{low_mm:.3},{high_mm:.3},{}\n",
            subject.task,
            one.inside()
        )
    };
    let lines = subjects.iter().zip(&calibration.tasks);
    let lines = lines
        .flat_map(|(subject, result)| result.left_out.iter().map(move |one| line(subject, one)));
    head + &lines.collect::<String>()
}

/// Returns `parameters.csv`: the percentiles of prior and posterior of each parameter.
pub fn parameters_csv(calibration: &Calibration) -> String {
    let head = "parameter,task,prior_low,prior_median,prior_high,posterior_low,posterior_median,posterior_high,moved,source\n";
    let line = |(one, coordinate): (ParameterUpdate, &Coordinate)| {
        let ParameterUpdate { name, task, moved, prior_low, prior_median, prior_high, .. } = &one;
        let ParameterUpdate { posterior_low, posterior_median, posterior_high, .. } = &one;
        let task = task.as_deref().unwrap_or_default();
        let source = coordinate.parameter.source.replace('"', "'");
        format!(
            "{name},{task},{prior_low:.3},{prior_median:.3},{prior_high:.3},{posterior_low:.3},\
             {posterior_median:.3},{posterior_high:.3},{moved},\"{source}\"\n"
        )
    };
    let lines = updates(calibration).into_iter().zip(&calibration.layout.coordinates).map(line);
    head.to_owned() + &lines.collect::<String>()
}

/// Number of fingers with the largest predicted ranges that are listed.
const LISTED: usize = 5;

/// Returns the fingers of the space with the largest predicted ranges and the one most probably the best, in the order
/// of their ranges, without those that were printed and inserted from no start.
pub fn best_fingers<'a>(subject: &Subject, result: &'a TaskResult) -> Vec<&'a Prediction> {
    let failed = subject.not_measurable();
    let inserts = |(finger, _): &(usize, &Prediction)| !failed.contains(finger);
    let all = result.predictions.iter().enumerate().filter(inserts);
    let mut order: Vec<&Prediction> = all.map(|(_, one)| one).collect();
    order.sort_by(|a, b| b.range_mm.total_cmp(&a.range_mm));
    listed(&order)
}

/// Returns the first of the ranked fingers and the one most probably the best, in their order.
fn listed<'a>(ranked: &[&'a Prediction]) -> Vec<&'a Prediction> {
    let probability = |i: &usize| ranked[*i].probability_best;
    let places = 0..ranked.len();
    let likeliest = places.clone().rev().max_by(|a, b| probability(a).total_cmp(&probability(b)));
    places.filter(|i| *i < LISTED || Some(*i) == likeliest).map(|i| ranked[i]).collect()
}

/// Returns the bench prediction for a study of one task; `simulated` is the evaluation of the best finger.
pub fn bench_prediction(
    subject: &Subject,
    result: &TaskResult,
    simulated: Evaluation,
    provenance: Provenance,
    effort: BenchEffort,
) -> BenchPrediction {
    let finger = |one: &&Prediction| BenchFinger {
        design: one.design.clone(),
        range_mm: one.range_mm,
        low_mm: one.low_mm,
        high_mm: one.high_mm,
        probability_best: one.probability_best,
        failures: [one.failure_negative, one.failure_positive],
    };
    let lines = subject.experiments.iter().map(|(finger, line)| (&subject.designs[*finger], line));
    let known = |(design, line): (&Design, &Experiment)| Some((design.clone(), line.range_mm?));
    let others = lines.clone().filter(|(_, line)| line.range_mm.is_none());
    let bound = |(design, line): (&Design, &Experiment)| {
        (design.clone(), line.extent().map(|(least_mm, _)| least_mm))
    };
    let verdict = result.verdict();
    let doubt = (!verdict.reliable).then_some(verdict.text);
    BenchPrediction {
        provenance,
        effort,
        measured: subject.measured().len(),
        ranges: lines.filter_map(known).collect(),
        bounds: others.map(bound).collect(),
        fingers: result.predictions.len(),
        trust: result.accuracy(subject.emulator.error_mm),
        warnings: doubt.into_iter().chain(warning(subject)).collect(),
        best: best_fingers(subject, result).iter().map(finger).collect(),
        simulated,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_contains_the_finger_that_is_most_probably_the_best() {
        let prediction = |(place, probability_best): (usize, f64)| {
            let range_mm = 9.0 - place as f64;
            let (low_mm, high_mm, simulated_mm) = (0.0, 9.0, range_mm);
            let (design, failure_negative, failure_positive) = (Design::default(), None, None);
            Prediction {
                design,
                range_mm,
                low_mm,
                high_mm,
                probability_best,
                simulated_mm,
                failure_negative,
                failure_positive,
            }
        };
        let ranges = |probabilities: [f64; 8]| {
            let all: Vec<_> = probabilities.into_iter().enumerate().map(prediction).collect();
            let listed = listed(&all.iter().collect::<Vec<_>>());
            listed.iter().map(|one| one.range_mm).collect::<Vec<_>>()
        };
        let first = [9.0, 8.0, 7.0, 6.0, 5.0];
        assert_eq!(ranges([0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.3, 0.0]), first);
        let with = [first.as_slice(), &[3.0]].concat();
        assert_eq!(ranges([0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.3, 0.0]), with);
    }
}
