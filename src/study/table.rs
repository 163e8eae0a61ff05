//! `evaluations.csv`: a study as a table, units in the headers.

use super::error::StudyError;
use super::folder::write_file;
use super::record::{Recorded, StudyRecord};
use crate::evaluation::Outcome;
use crate::units::N_PER_MM;
use std::path::Path;

const MEASURED: [&str; 21] = [
    "objective_mm",
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
    let keys: Vec<&str> = record.config.space.parameters().iter().map(|p| p.key.as_str()).collect();
    writer.write_record(["evaluation"].iter().chain(&keys).chain(&MEASURED))?;
    for recorded in &record.evaluations {
        let design = keys.iter().map(|key| number(recorded.design.get(key)));
        let index = std::iter::once(recorded.index.to_string());
        writer.write_record(index.chain(design).chain(measured(recorded)))?;
    }
    Ok(writer.into_inner()?)
}

fn measured(recorded: &Recorded) -> [String; MEASURED.len()] {
    let (found, stiffness) = (&recorded.evaluation, &recorded.stiffness);
    let (window, counts) = (&found.window, found.failure_counts);
    let n_per_mm = |n_per_m: f64| format!("{:.4}", n_per_m / N_PER_MM);
    [
        number(recorded.value),
        number(Some(window.range_mm())),
        number(Some(window.negative_mm())),
        number(Some(window.positive_mm())),
        word(Some(window.nominal)),
        word(window.end_negative),
        word(window.end_positive),
        counts[0].to_string(),
        counts[1].to_string(),
        counts[2].to_string(),
        counts[3].to_string(),
        found.diverged.to_string(),
        found.trials.to_string(),
        number(Some(found.peak_force_n)),
        number(Some(found.slip_mm)),
        number(Some(found.simulated_s)),
        n_per_mm(stiffness.compliance.mean),
        n_per_mm(stiffness.compliance.sd),
        n_per_mm(stiffness.assembly.mean),
        n_per_mm(stiffness.assembly.sd),
        number(Some(stiffness.hull_distance)),
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
