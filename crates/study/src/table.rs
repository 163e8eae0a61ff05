//! `evaluations.csv`: table of the evaluations with the keys of JSON and journal, units in the header.

use super::{Recorded, StudyError, StudyRecord};
use insertion::Score;
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

/// File of the table in the folder of a study.
pub const EVALUATIONS_CSV: &str = "evaluations.csv";
/// Keys of lists with a value for each draw, which are left out of the table.
const PER_DRAW: [&str; 2] = ["robust_ranges_mm", "success_failed_draws"];

/// Names of the columns with their cells, in order.
type Row = Vec<(String, String)>;

/// Returns the text of `evaluations.csv`; `dir` is named in errors.
///
/// # Errors
/// If it cannot be written as CSV.
pub fn evaluations_csv(dir: &Path, record: &StudyRecord) -> Result<String, StudyError> {
    csv(record).map_err(|error| StudyError::file(&dir.join(EVALUATIONS_CSV), error))
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
        row.push((parameter.key.to_string(), value.map(|v| v.to_string()).unwrap_or_default()));
    }
    let score = |of: fn(&Score) -> &[f64], i: usize| {
        let value = recorded.score.as_ref().and_then(|score| of(score).get(i));
        value.map_or(String::new(), |value| value.to_string())
    };
    for (i, key) in config.objective.keys().into_iter().enumerate() {
        // A raced rate has no value; its upper bound is a column of the task.
        let value = (!recorded.raced()).then(|| score(|score| &score.values, i));
        row.push((key, value.unwrap_or_default()));
    }
    for (i, constraint) in config.constraints.iter().enumerate() {
        // Share of the limit, without a unit.
        row.push((format!("violation {constraint}"), score(|score| &score.violations, i)));
    }
    for (task, measured) in config.tasks().zip(&recorded.tasks) {
        let prefix = if config.tasks.len() == 1 { String::new() } else { format!("{task}.") };
        cells(&prefix, measured, &mut row)?;
    }
    cells("stiffness_", &recorded.stiffness, &mut row)?;
    Ok(row)
}

/// Adds the fields of an object that contains no objects; elements of a list are numbered from 1.
fn cells(prefix: &str, value: &impl Serialize, row: &mut Row) -> Result<(), serde_json::Error> {
    let Value::Object(fields) = serde_json::to_value(value)? else { return Ok(()) };
    for (key, value) in fields.into_iter().filter(|(key, _)| !PER_DRAW.contains(&&**key)) {
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

/// Formats a cell; `null` gives an empty one.
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
