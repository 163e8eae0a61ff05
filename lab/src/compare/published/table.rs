//! `validation.csv` and `accuracy.md`.

use super::{Agreement, COMPARISONS, DesignRow, TaskTable, deviation_percent};
use input::units::N_PER_MM;
use insertion::outcome::Outcome;

/// Columns of `validation.csv`; a deviation is `|range - reference| / reference`.
pub const CSV_HEADER: &str = "task,design,infill_density_percent,infill_direction_deg,\
    stiffness_assembly_n_per_mm,stiffness_compliance_n_per_mm,nominal,\
    negative_mm,positive_mm,range_mm,failure_negative,failure_positive,\
    simulation_range_mm,simulation_failure_negative,simulation_failure_positive,\
    bench_range_mm,bench_failure_negative,bench_failure_positive,\
    error_to_simulation_mm,deviation_to_simulation_percent,\
    error_to_bench_mm,deviation_to_bench_percent,\
    simulation_error_to_bench_mm,simulation_deviation_to_bench_percent";

/// Returns `validation.csv`, a line for each task and design; an error is range minus reference.
pub fn csv(tables: &[TaskTable]) -> String {
    let rows = tables.iter().flat_map(|table| table.rows.iter().map(|row| (&table.task, row)));
    let lines = rows.map(|(task, row)| format!("{task},{}\n", cells(row).join(",")));
    format!("{CSV_HEADER}\n") + &lines.collect::<String>()
}

fn cells(row: &DesignRow) -> Vec<String> {
    let (design, window) = (&row.design, &row.window);
    let word = |end: Option<Outcome>| match end {
        Some(Outcome::Failed(class)) => class.number().to_string(),
        Some(Outcome::Diverged) => "diverged".to_owned(),
        Some(Outcome::Inserted) | None => String::new(),
    };
    let inserted = window.nominal == Outcome::Inserted;
    // Without a window there are no ends.
    let end = |end| word(end).repeat(usize::from(inserted));
    let mut cells = vec![
        design.design.to_string(),
        design.density_percent.to_string(),
        design.direction_deg.to_string(),
        (design.assembly / N_PER_MM).to_string(),
        (design.compliance / N_PER_MM).to_string(),
        if inserted { "inserted".to_owned() } else { word(Some(window.nominal)) },
        window.negative_mm().to_string(),
        window.positive_mm().to_string(),
        number(row.range_mm(0)),
        end(window.end_negative),
        end(window.end_positive),
    ];
    for reading in &row.readings[1..] {
        cells.push(number(reading.and_then(|reading| reading.range_mm)));
        cells.push(word(reading.and_then(|r| r.failure_negative).map(Outcome::Failed)));
        cells.push(word(reading.and_then(|r| r.failure_positive).map(Outcome::Failed)));
    }
    for [source, reference] in COMPARISONS {
        let pair = row.range_mm(source).zip(row.range_mm(reference));
        cells.push(number(pair.map(|(a, b)| a - b)));
        cells.push(number(pair.map(|(a, b)| deviation_percent(a, b))));
    }
    cells
}

/// Formats a cell with one decimal, empty without a value; never as a negative zero.
fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |v| format!("{:.1}", (v * 10.0).round() / 10.0 + 0.0))
}

/// Returns a Markdown table with a line for each task. A column compares two sources by the mean absolute error of the
/// range, Spearman's rank correlation, and the percentage of the window ends with the same failure class.
pub fn accuracy(tables: &[TaskTable]) -> String {
    let head = "| task | starts | ours - simulation | ours - bench | simulation - bench |\n\
                | --- | --- | --- | --- | --- |\n";
    let line = |table: &TaskTable| {
        let [simulation, bench, published] = table.agreements().map(words);
        let inserts = |row: &&DesignRow| row.window.nominal == Outcome::Inserted;
        let (inserted, all) = (table.rows.iter().filter(inserts).count(), table.rows.len());
        let task = &table.task;
        format!("| {task} | {inserted} of {all} | {simulation} | {bench} | {published} |\n")
    };
    head.to_owned() + &tables.iter().map(line).collect::<String>()
}

/// Formats an agreement as `0.99 mm, +0.96, 100.0 %`, with `-` for an undefined value.
fn words(found: Agreement) -> String {
    let value =
        |value: Option<f64>, words: &dyn Fn(f64) -> String| value.map_or("-".to_owned(), words);
    [
        value(found.mean_absolute_error_mm, &|error| format!("{error:.2} mm")),
        value(found.spearman, &|rank| format!("{:+.2}", (100.0 * rank).round() / 100.0 + 0.0)),
        value(found.match_percent, &|share| format!("{share:.1} %")),
    ]
    .join(", ")
}
