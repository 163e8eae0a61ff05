//! `evaluations.csv`: a study as a table, units in the headers. What was measured stands in
//! it under the keys that JSON and journal have.

use super::error::StudyError;
use super::folder::write_own_file;
use super::record::{Recorded, StudyRecord};
use insertion::evaluation::objective::Score;
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

const TABLE: &str = "evaluations.csv";
/// Lists of as many values as there were draws: no columns.
const DRAWN: [&str; 2] = ["robust_ranges_mm", "success_failed_draws"];

/// Column and cell, in the order of the columns.
type Row = Vec<(String, String)>;

/// Writes `evaluations.csv` into a study's folder, one row per evaluation.
pub fn write_evaluations_csv(dir: &Path, record: &StudyRecord) -> Result<(), StudyError> {
    write_own_file(&dir.join(TABLE), &evaluations_csv(dir, record)?)
}

/// The text of `evaluations.csv`; `dir` is named in errors.
pub fn evaluations_csv(dir: &Path, record: &StudyRecord) -> Result<String, StudyError> {
    csv(record).map_err(|error| StudyError::file(&dir.join(TABLE), error))
}

fn csv(record: &StudyRecord) -> Result<String, Box<dyn std::error::Error>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut header: Vec<String> = Vec::new();
    for recorded in &record.evaluations {
        let row = row(record, recorded)?;
        if header.is_empty() {
            header = row.iter().map(|(column, _)| column.clone()).collect();
            writer.write_record(&header)?;
        }
        let cell = |column: &String| {
            row.iter().find(|(name, _)| name == column).map_or("", |(_, cell)| cell.as_str())
        };
        writer.write_record(header.iter().map(cell))?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

fn row(record: &StudyRecord, recorded: &Recorded) -> Result<Row, serde_json::Error> {
    let config = &record.config;
    let mut row = vec![("evaluation".to_owned(), recorded.index.to_string())];
    for parameter in &config.space.parameters {
        let value = recorded.design.get(&parameter.key);
        row.push((
            parameter.key.to_string(),
            value.map_or(String::new(), |value| value.to_string()),
        ));
    }
    let score = |of: fn(&Score) -> &[f64], i: usize| {
        let value = recorded.score.as_ref().and_then(|score| of(score).get(i));
        value.map_or(String::new(), |value| value.to_string())
    };
    for (i, key) in config.objective.keys().into_iter().enumerate() {
        // A raced rate has no value; its upper bound stands with the task.
        let value = (!recorded.raced()).then(|| score(|score| &score.values, i));
        row.push((key, value.unwrap_or_default()));
    }
    for (i, constraint) in config.constraints.iter().enumerate() {
        // A share of the limit, so without a unit.
        row.push((format!("violation {constraint}"), score(|score| &score.violations, i)));
    }
    for (task, measured) in config.tasks().zip(&recorded.tasks) {
        let prefix = if config.tasks.len() == 1 { String::new() } else { format!("{task}.") };
        cells(&prefix, measured, &mut row)?;
    }
    cells("stiffness_", &recorded.stiffness, &mut row)?;
    Ok(row)
}

/// The fields of a flat value; those of a list by their place, counted from 1.
fn cells(prefix: &str, value: &impl Serialize, row: &mut Row) -> Result<(), serde_json::Error> {
    let Value::Object(fields) = serde_json::to_value(value)? else { return Ok(()) };
    for (key, value) in fields.into_iter().filter(|(key, _)| !DRAWN.contains(&&**key)) {
        match value {
            Value::Array(values) => {
                for (i, value) in (1..).zip(values) {
                    row.push((format!("{prefix}{key}_{i}"), cell(value)));
                }
            }
            value => row.push((format!("{prefix}{key}"), cell(value))),
        }
    }
    Ok(())
}

/// Empty where there is no value.
fn cell(value: Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text,
        Value::Number(number) if number.is_f64() => {
            number.as_f64().map_or(String::new(), |number| number.to_string())
        }
        other => other.to_string(),
    }
}
