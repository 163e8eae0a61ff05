//! `evaluations.csv`: a study as a table, units in the headers.

use super::error::StudyError;
use super::folder::write_file;
use super::record::{Recorded, StudyRecord};
use crate::evaluation::objective::{Goals, Measure, Score};
use crate::evaluation::{Evaluation, RobustRange, SuccessRate};
use crate::outcome::Outcome;
use crate::units::N_PER_MM;
use std::path::Path;

/// What the window search of one task measured.
const WINDOW: [&str; 15] = [
    "range_mm",
    "negative_mm",
    "positive_mm",
    "nominal",
    "end_negative",
    "end_positive",
    "failures_1",
    "failures_2",
    "failures_3",
    "failures_4",
    "diverged",
    "trials",
    "peak_force_n",
    "slip_mm",
    "simulated_s",
];

/// What trials under drawn errors measured.
const SUCCESS: [&str; 9] = [
    "success_rate",
    "success_low",
    "success_high",
    "success_inserted",
    "success_failures_1",
    "success_failures_2",
    "success_failures_3",
    "success_failures_4",
    "success_diverged",
];

/// What windows under drawn errors measured.
const ROBUST: [&str; 5] =
    ["robust_range_mm", "robust_mean_mm", "robust_sd_mm", "robust_windows", "robust_diverged"];

const STIFFNESS: [&str; 5] = [
    "stiffness_compliance_n_per_mm",
    "stiffness_compliance_sd_n_per_mm",
    "stiffness_assembly_n_per_mm",
    "stiffness_assembly_sd_n_per_mm",
    "hull_distance",
];

/// Writes `evaluations.csv` into a study's folder, one row per evaluation.
pub fn write_evaluations_csv(dir: &Path, record: &StudyRecord) -> Result<(), StudyError> {
    let path = dir.join("evaluations.csv");
    let table = |record| -> Result<String, Box<dyn std::error::Error>> {
        Ok(String::from_utf8(csv(record)?)?)
    };
    let text = table(record)
        .map_err(|error| StudyError::File { path: path.clone(), problem: error.to_string() })?;
    write_file(&path, &text)
}

fn csv(record: &StudyRecord) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let (config, goals) = (&record.config, record.config.goals());
    let keys: Vec<&str> = config.space.parameters().iter().map(|p| p.key.as_str()).collect();
    let mut header = vec!["evaluation".to_owned()];
    header.extend(keys.iter().map(|&key| key.to_owned()));
    header.extend(config.objective.keys());
    // A share of the limit, so without a unit.
    header.extend(config.constraints.iter().map(|c| format!("violation {c}")));
    for task in config.tasks() {
        let alone = config.other_tasks.is_empty();
        let named = |key: &str| if alone { key.to_owned() } else { format!("{task}.{key}") };
        header.extend(of_task(&goals).map(named));
    }
    header.extend(STIFFNESS.map(str::to_owned));
    writer.write_record(&header)?;
    for recorded in &record.evaluations {
        let mut row = vec![recorded.index.to_string()];
        row.extend(keys.iter().map(|key| number(recorded.design.get(key))));
        row.extend(scores(recorded, &goals));
        row.extend(recorded.tasks().into_iter().flat_map(|found| measured(found, &goals)));
        row.extend(stiffness(recorded));
        writer.write_record(&row)?;
    }
    Ok(writer.into_inner()?)
}

/// The columns of each task.
fn of_task(goals: &Goals) -> impl Iterator<Item = &'static str> {
    let success = goals.need(Measure::SuccessRate).then_some(SUCCESS);
    let robust = goals.need(Measure::RobustRange).then_some(ROBUST);
    let drawn = success.into_iter().flatten().chain(robust.into_iter().flatten());
    WINDOW.into_iter().chain(drawn)
}

/// Objectives and violations, empty where there is no score.
fn scores(recorded: &Recorded, goals: &Goals) -> Vec<String> {
    let score = recorded.score.as_ref();
    let cells = |count: usize, of: fn(&Score) -> &[f64]| {
        (0..count).map(move |i| number(score.and_then(|score| of(score).get(i).copied())))
    };
    cells(goals.objectives.measures().len(), |score| &score.values)
        .chain(cells(goals.constraints.len(), |score| &score.violations))
        .collect()
}

fn measured(found: &Evaluation, goals: &Goals) -> Vec<String> {
    let (window, counts) = (&found.window, found.failure_counts.map(|count| count.to_string()));
    let mut row = vec![
        number(Some(window.range_mm())),
        number(Some(window.negative_mm())),
        number(Some(window.positive_mm())),
        word(Some(window.nominal)),
        word(window.end_negative),
        word(window.end_positive),
    ];
    row.extend(counts);
    row.extend([
        found.diverged.to_string(),
        found.trials.to_string(),
        number(Some(found.peak_force_n)),
        number(Some(found.slip_mm)),
        number(Some(found.simulated_s)),
    ]);
    let empty = |columns: usize| vec![String::new(); columns];
    if goals.need(Measure::SuccessRate) {
        row.extend(found.success.as_ref().map_or_else(|| empty(SUCCESS.len()), success));
    }
    if goals.need(Measure::RobustRange) {
        row.extend(found.robust.as_ref().map_or_else(|| empty(ROBUST.len()), robust));
    }
    row
}

fn success(found: &SuccessRate) -> Vec<String> {
    let [low, high] = found.interval();
    let mut row = vec![number(found.rate()), number(Some(low)), number(Some(high))];
    row.push(found.inserted.to_string());
    row.extend(found.failure_counts.map(|count| count.to_string()));
    row.push(found.diverged.to_string());
    row
}

fn robust(found: &RobustRange) -> Vec<String> {
    let some = |value: f64| number(Some(value).filter(|value| value.is_finite()));
    let windows = found.ranges_mm.len().to_string();
    let (mean, sd) = (some(found.mean_mm()), some(found.sd_mm()));
    vec![number(found.value_mm), mean, sd, windows, found.diverged.to_string()]
}

fn stiffness(recorded: &Recorded) -> [String; STIFFNESS.len()] {
    let n_per_mm = |n_per_m: f64| format!("{:.4}", n_per_m / N_PER_MM);
    let predicted = &recorded.stiffness;
    [
        n_per_mm(predicted.compliance.mean),
        n_per_mm(predicted.compliance.sd),
        n_per_mm(predicted.assembly.mean),
        n_per_mm(predicted.assembly.sd),
        number(Some(predicted.hull_distance)),
    ]
}

/// An empty cell where there is no value.
fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

/// The failure class where there is one, else the outcome.
fn word(outcome: Option<Outcome>) -> String {
    match outcome {
        None => String::new(),
        Some(Outcome::Inserted) => "inserted".to_owned(),
        Some(Outcome::Failed(class)) => class.number().to_string(),
        Some(Outcome::Diverged) => "diverged".to_owned(),
    }
}
