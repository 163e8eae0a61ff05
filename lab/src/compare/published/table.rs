//! `validation.csv`, `validation_summary.csv` and the JSON of the command.

use super::agreement::deviation_percent;
use super::targets::targets;
use super::{Agreement, COMPARISONS, DesignRow, Reading, TaskTable};
use crate::compare::{subject_json, window_json};
use input::units::N_PER_MM;
use insertion::outcome::Outcome;
use serde_json::{Value, json};

/// Columns of `validation.csv`; a deviation is `|range - reference| / reference`.
pub const CSV_HEADER: &str = "task,design,infill_density_percent,infill_direction_deg,\
    stiffness_assembly_n_per_mm,stiffness_compliance_n_per_mm,nominal,\
    negative_mm,positive_mm,range_mm,failure_negative,failure_positive,\
    simulation_range_mm,simulation_failure_negative,simulation_failure_positive,\
    bench_range_mm,bench_failure_negative,bench_failure_positive,\
    error_to_simulation_mm,deviation_to_simulation_percent,\
    error_to_bench_mm,deviation_to_bench_percent,\
    simulation_error_to_bench_mm,simulation_deviation_to_bench_percent";

/// Columns of `validation_summary.csv`.
pub const SUMMARY_HEADER: &str = "task,compared,reference,designs,mean_absolute_error_mm,\
    mean_error_mm,mean_deviation_percent,spearman,matched_ends,ends,match_percent";

/// `validation.csv`, a line for each task and design; errors are range minus reference.
pub fn csv(tables: &[TaskTable]) -> String {
    let line = |table: &TaskTable, row: &DesignRow| {
        let mut cells = vec![table.task.clone()];
        cells.extend(design_cells(row));
        cells.extend(reading_cells(row));
        for (source, reference) in COMPARISONS {
            let range = |source| row.reading(source)?.range_mm;
            let pair = range(source).zip(range(reference));
            cells.push(number(pair.map(|(a, b)| a - b), 1));
            cells.push(number(pair.map(|(a, b)| deviation_percent(a, b)), 1));
        }
        cells.join(",")
    };
    let lines = tables.iter().flat_map(|t| t.rows.iter().map(move |row| line(t, row)));
    lines_of(CSV_HEADER, lines)
}

/// `validation_summary.csv`, a line for each task and comparison.
pub fn summary_csv(tables: &[TaskTable]) -> String {
    let line = |table: &TaskTable, found: Agreement| {
        [
            table.task.clone(),
            found.source.names()[1].to_owned(),
            found.reference.names()[1].to_owned(),
            found.designs.to_string(),
            number(found.mean_absolute_error_mm, 3),
            number(found.mean_error_mm, 3),
            number(found.mean_deviation_percent, 2),
            number(found.spearman, 3),
            found.matched_ends.to_string(),
            found.ends.to_string(),
            number(found.match_percent, 1),
        ]
        .join(",")
    };
    let lines = tables.iter().flat_map(|t| t.agreements().map(|found| line(t, found)));
    lines_of(SUMMARY_HEADER, lines)
}

fn lines_of(header: &str, lines: impl Iterator<Item = String>) -> String {
    [header.to_owned()].into_iter().chain(lines).map(|line| line + "\n").collect()
}

fn design_cells(row: &DesignRow) -> [String; 5] {
    let design = &row.design;
    [
        design.design.to_string(),
        design.density_percent.to_string(),
        design.direction_deg.to_string(),
        (design.assembly / N_PER_MM).to_string(),
        (design.compliance / N_PER_MM).to_string(),
    ]
}

fn reading_cells(row: &DesignRow) -> Vec<String> {
    let window = &row.window;
    let word = |end: Option<Outcome>| match end {
        Some(Outcome::Failed(class)) => class.number().to_string(),
        Some(Outcome::Diverged) => "diverged".to_owned(),
        Some(Outcome::Inserted) | None => String::new(),
    };
    let nominal = match window.nominal {
        Outcome::Inserted => "inserted".to_owned(),
        other => word(Some(other)),
    };
    // Without a window there are no ends.
    let end = |end| word(end).repeat(usize::from(window.nominal == Outcome::Inserted));
    let mut cells = vec![
        nominal,
        window.negative_mm().to_string(),
        window.positive_mm().to_string(),
        number(Reading::from(window).range_mm, 1),
        end(window.end_negative),
        end(window.end_positive),
    ];
    for reading in [row.simulation, row.bench] {
        cells.push(number(reading.and_then(|r| r.range_mm), 1));
        let failures = reading.map_or([None; 2], |r| r.failures);
        cells.extend(failures.map(|c| c.map_or(String::new(), |c| c.number().to_string())));
    }
    cells
}

/// Cell of a number, empty without a value; never a negative zero.
fn number(value: Option<f64>, digits: usize) -> String {
    let scale = 10f64.powi(digits as i32);
    value.map_or(String::new(), |v| format!("{:.digits$}", (v * scale).round() / scale + 0.0))
}

/// JSON list of tasks with `designs`, `agreement` and `targets`.
pub fn json(tables: &[TaskTable]) -> Value {
    let task = |table: &TaskTable| {
        json!({
            "task": table.task,
            "designs": table.rows.iter().map(|row| row_json(&table.task, row)).collect::<Vec<_>>(),
            "agreement": table.agreements(),
            "targets": targets(table),
        })
    };
    tables.iter().map(task).collect()
}

fn row_json(task: &str, row: &DesignRow) -> Value {
    let reading = |reading: Option<Reading>| {
        reading.map(|r| {
            json!({
                "range_mm": r.range_mm,
                "failure_negative": r.failures[0],
                "failure_positive": r.failures[1],
            })
        })
    };
    let measured = json!({
        "window": window_json(&row.window),
        "ours": reading(Some(Reading::from(&row.window))),
        "simulation": reading(row.simulation),
        "bench": reading(row.bench),
    });
    subject_json(task, &row.design, measured)
}
