//! A calibration as JSON, as CSV, as text, and as a study keeps it.

use super::calibrate::{Calibration, Coordinate, LeftOut, Prediction, TaskResult};
use super::predict::Predicted;
use super::subject::Subject;
use crate::experiments::Experiment;
use ask_tell::statistics::{Moments, normal_cdf, pearson, quantile, sorted};
use insertion::evaluation::Evaluation;
use insertion::space::{DENSITY_KEY, DIRECTION_KEY, Design};
use serde_json::{Map, Value, json};
use study::{BenchEffort, BenchFinger, OnBench, Provenance};

/// Standard deviation and mean of a coordinate, whose prior has 1 and 0, at which it moved.
const MOVED: (f64, f64) = (0.75, 0.5);
/// Correlation at which two parameters cannot be told apart.
const TOGETHER: f64 = 0.5;

#[derive(Debug, Clone)]
pub struct Moved {
    pub name: String,
    pub task: Option<String>,
    /// The 10th, 50th and 90th percentile before, in its own unit.
    pub prior: [f64; 3],
    /// The same after.
    pub posterior: [f64; 3],
    /// Whether the measurements moved or narrowed it.
    pub moved: bool,
}

pub fn moved(calibration: &Calibration) -> Vec<Moved> {
    let one = |(i, Coordinate { parameter, task }): (usize, &Coordinate)| {
        let values = sorted(coordinate(calibration, i));
        let moments = Moments::of(coordinate(calibration, i));
        let at = |share: f64| quantile(&values, share).unwrap_or(0.0);
        let shares = [0.1, 0.5, 0.9];
        Moved {
            name: parameter.name.clone(),
            task: task.clone(),
            prior: shares.map(|share| parameter.at(share)),
            posterior: shares.map(|share| parameter.at(normal_cdf(at(share)))),
            moved: moments.deviation() < MOVED.0 || moments.mean.abs() > MOVED.1,
        }
    };
    calibration.layout.coordinates.iter().enumerate().map(one).collect()
}

fn coordinate(calibration: &Calibration, i: usize) -> Vec<f64> {
    calibration.posterior.iter().map(|state| state[i]).collect()
}

/// Pairs of parameters that the measurements cannot tell apart, with their correlation.
pub fn together(calibration: &Calibration) -> Vec<(String, String, f64)> {
    let names = &calibration.layout.coordinates;
    let mut found = Vec::new();
    for i in 0..names.len() {
        for j in 0..i {
            let (a, b) = (coordinate(calibration, j), coordinate(calibration, i));
            let correlation = pearson(&a, &b).unwrap_or(0.0);
            if correlation.abs() > TOGETHER {
                found.push((
                    names[j].parameter.name.clone(),
                    names[i].parameter.name.clone(),
                    correlation,
                ));
            }
        }
    }
    found
}

/// Caveats on a task's predictions, a line each.
pub fn warnings(subject: &Subject, result: &TaskResult) -> Vec<String> {
    let accuracy = result.trust(subject.emulator.error_mm);
    let mut lines = Vec::new();
    let scale = subject.emulator.mean_mm.max(1.0);
    if accuracy.fingers < 3 {
        let words = "fewer than 3 measured fingers: the intervals rest on the priors";
        lines.push(words.to_owned());
    }
    // By chance fewer than half of five or more fall inside in 1 case of 20.
    if accuracy.fingers >= 5 && 2 * accuracy.inside < accuracy.fingers {
        lines.push(format!(
            "the fit is worse than its own error bars: {} of {} left-out fingers lie inside their intervals",
            accuracy.inside, accuracy.fingers
        ));
    }
    if accuracy.fingers >= 5 && accuracy.spearman.is_none_or(|rank| rank < 0.3) {
        let rank = accuracy.spearman.map_or("none".to_owned(), |rank| format!("{rank:+.2}"));
        lines.push(format!(
            "the order of the fingers is not predictable here: Spearman {rank} leave-one-out"
        ));
    }
    if subject.emulator.error_mm > 0.2 * scale {
        lines.push(format!(
            "the emulator misses fresh simulations by {:.1} mm, more than a fifth of their mean: the \
             predictions rest on the measurements; more --simulations may help",
            subject.emulator.error_mm
        ));
    }
    lines
}

pub fn design_json(design: &Design) -> Map<String, Value> {
    design.0.iter().map(|(key, value)| (key.clone(), json!(value))).collect()
}

/// Numbers of a prediction: key, value, and decimals in a table.
fn numbers(prediction: &Prediction) -> [(&'static str, f64, usize); 5] {
    let Predicted { mean_mm, low_mm, high_mm, simulated_mm } = prediction.range;
    [
        ("range_mm", mean_mm, 3),
        ("low_mm", low_mm, 3),
        ("high_mm", high_mm, 3),
        ("probability_best", prediction.best, 4),
        ("simulated_mm", simulated_mm, 3),
    ]
}

pub fn json(calibration: &Calibration, subjects: &[Subject]) -> Value {
    let tasks =
        subjects.iter().zip(&calibration.tasks).map(|(subject, result)| task_json(subject, result));
    let parameters = moved(calibration).into_iter().map(|Moved { name, task, prior, posterior, moved }| {
        json!({
            "name": name,
            "task": task,
            "prior_low": prior[0], "prior_median": prior[1], "prior_high": prior[2],
            "posterior_low": posterior[0], "posterior_median": posterior[1], "posterior_high": posterior[2],
            "moved": moved,
        })
    });
    let together = together(calibration)
        .into_iter()
        .map(|(a, b, correlation)| json!({"parameters": [a, b], "correlation": correlation}));
    json!({
        "tasks": tasks.collect::<Vec<_>>(),
        "parameters": parameters.collect::<Vec<_>>(),
        "not_told_apart": together.collect::<Vec<_>>(),
    })
}

fn task_json(subject: &Subject, result: &TaskResult) -> Value {
    let accuracy = result.trust(subject.emulator.error_mm);
    let coverage_percent =
        (accuracy.fingers > 0).then(|| 100.0 * accuracy.inside as f64 / accuracy.fingers as f64);
    let predictions = result.predictions.iter().map(|prediction| {
        let mut fields = design_json(&subject.designs[prediction.finger]);
        fields.extend(numbers(prediction).map(|(key, value, _)| (key.to_owned(), json!(value))));
        let [below, above] = subject.failures(prediction.finger);
        fields.insert("failure_negative".into(), json!(below));
        fields.insert("failure_positive".into(), json!(above));
        Value::Object(fields)
    });
    let left_out = result.left_out.iter().map(|one| {
        let mut fields = design_json(&subject.designs[one.finger]);
        fields.insert("measured_mm".into(), json!(one.measured_mm));
        fields.insert("range_mm".into(), json!(one.predicted.mean_mm));
        fields.insert("low_mm".into(), json!(one.predicted.low_mm));
        fields.insert("high_mm".into(), json!(one.predicted.high_mm));
        Value::Object(fields)
    });
    json!({
        "task": subject.task,
        "designs": accuracy.fingers,
        "loo_mean_deviation_percent": accuracy.mean_deviation_percent,
        "loo_spearman": accuracy.spearman,
        "loo_coverage_80_percent": coverage_percent,
        "simulations": subject.emulator.simulations,
        "fresh_simulations": subject.emulator.fresh,
        "emulator_error_mm": subject.emulator.error_mm,
        "warnings": warnings(subject, result),
        "leave_one_out": left_out.collect::<Vec<_>>(),
        "predictions": predictions.collect::<Vec<_>>(),
    })
}

/// `predictions.csv` of one task: a line per finger of the space.
pub fn predictions_csv(subject: &Subject, result: &TaskResult) -> String {
    let keys: Vec<&String> =
        subject.designs.first().map(|design| design.0.keys().collect()).unwrap_or_default();
    let head: Vec<&str> = keys.iter().map(|key| key.as_str()).collect();
    let mut text = format!(
        "task,{},range_mm,low_mm,high_mm,probability_best,simulated_mm,failure_negative,failure_positive\n",
        head.join(",")
    );
    for prediction in &result.predictions {
        let design = &subject.designs[prediction.finger];
        let values: Vec<String> = keys.iter().map(|key| design.0[*key].to_string()).collect();
        let numbers = numbers(prediction).map(|(_, value, digits)| format!("{value:.digits$}"));
        let ends = subject.failures(prediction.finger);
        let ends = ends.map(|end| end.map_or(String::new(), |class| class.number().to_string()));
        let cells = [values.join(","), numbers.join(","), ends.join(",")].join(",");
        text += &format!("{},{cells}\n", subject.task);
    }
    text
}

pub fn left_out_csv(calibration: &Calibration, subjects: &[Subject]) -> String {
    let head =
        format!("task,{DENSITY_KEY},{DIRECTION_KEY},measured_mm,range_mm,low_mm,high_mm,inside\n");
    let line = |subject: &Subject, one: &LeftOut| {
        let design = &subject.designs[one.finger];
        let value = |key: &str| design.get(key).map_or(String::new(), |value| value.to_string());
        format!(
            "{},{},{},{:.2},{:.3},{:.3},{:.3},{}\n",
            subject.task,
            value(DENSITY_KEY),
            value(DIRECTION_KEY),
            one.measured_mm,
            one.predicted.mean_mm,
            one.predicted.low_mm,
            one.predicted.high_mm,
            one.inside()
        )
    };
    let lines = subjects.iter().zip(&calibration.tasks);
    let lines = lines
        .flat_map(|(subject, result)| result.left_out.iter().map(move |one| line(subject, one)));
    head + &lines.collect::<String>()
}

/// `parameters.csv`: the 10th, 50th and 90th percentile of each parameter before and after.
pub fn parameters_csv(calibration: &Calibration) -> String {
    let head = "parameter,task,prior_low,prior_median,prior_high,posterior_low,posterior_median,posterior_high,moved,source\n";
    let line = |(moved, coordinate): (Moved, &Coordinate)| {
        let numbers = moved.prior.iter().chain(&moved.posterior).map(|value| format!("{value:.3}"));
        let numbers: Vec<String> = numbers.collect();
        format!(
            "{},{},{},{},\"{}\"\n",
            moved.name,
            moved.task.unwrap_or_default(),
            numbers.join(","),
            moved.moved,
            coordinate.parameter.source.replace('"', "'")
        )
    };
    let lines = moved(calibration).into_iter().zip(&calibration.layout.coordinates).map(line);
    head.to_owned() + &lines.collect::<String>()
}

const KEPT: usize = 5;

/// The fingers of the space by their predicted ranges, best first.
pub fn by_range(result: &TaskResult) -> Vec<&Prediction> {
    let mut order: Vec<&Prediction> = result.predictions.iter().collect();
    order.sort_by(|a, b| b.range.mean_mm.total_cmp(&a.range.mean_mm));
    order
}

/// Prediction of a calibration for a study's one task; `simulated` is the best finger's evaluation.
pub fn on_bench(
    subject: &Subject,
    result: &TaskResult,
    simulated: Evaluation,
    provenance: Provenance,
    effort: BenchEffort,
) -> OnBench {
    let finger = |prediction: &&Prediction| BenchFinger {
        design: subject.designs[prediction.finger].clone(),
        range_mm: prediction.range.mean_mm,
        low_mm: prediction.range.low_mm,
        high_mm: prediction.range.high_mm,
        probability_best: prediction.best,
        failures: subject.failures(prediction.finger),
    };
    let lines = subject.experiments.iter().map(|(finger, line)| (&subject.designs[*finger], line));
    let known = |(design, line): (&Design, &Experiment)| Some((design.clone(), line.range_mm()?));
    let others = lines.clone().filter(|(_, line)| line.range_mm().is_none());
    let bound = |(design, line): (&Design, &Experiment)| {
        (design.clone(), line.extent().map(|(least_mm, _)| least_mm))
    };
    OnBench {
        provenance,
        effort,
        measured: subject.measured().len(),
        ranges: lines.filter_map(known).collect(),
        bounds: others.map(bound).collect(),
        fingers: result.predictions.len(),
        trust: result.trust(subject.emulator.error_mm),
        warnings: warnings(subject, result),
        best: by_range(result).iter().take(KEPT).map(finger).collect(),
        simulated,
    }
}
