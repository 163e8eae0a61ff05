//! Agreement of the simulations with each other and with the experiments, a line for each task.

use super::{Agreement, RangeSource, TaskTable};
use serde_json::{Value, json};

/// A Markdown table; each comparison is mean absolute error of the range, Spearman's rank
/// correlation, and share of the window ends with the same failure class.
pub fn accuracy(tables: &[TaskTable]) -> String {
    let head = "| task | starts | ours - simulation | ours - bench | simulation - bench |\n\
                | --- | --- | --- | --- | --- |\n";
    let line = |table: &TaskTable| {
        let [simulation, bench, published] = table.agreements().map(words);
        let (inserted, all) = (table.nominal_inserted(), table.rows.len());
        let task = &table.task;
        format!("| {task} | {inserted} of {all} | {simulation} | {bench} | {published} |\n")
    };
    head.to_owned() + &tables.iter().map(line).collect::<String>()
}

/// `0.99 mm, +0.96, 100.0 %`, with `-` for what is not defined.
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

/// Our agreement and the published simulation's with the experiments: a list of tasks.
pub fn accuracy_json(tables: &[TaskTable]) -> Value {
    let task = |table: &TaskTable| {
        let with_bench = |source| Agreement::of(&table.rows, source, RangeSource::Bench);
        json!({
            "task": table.task,
            "ours": with_bench(RangeSource::Ours),
            "simulation": with_bench(RangeSource::Simulation),
        })
    };
    tables.iter().map(task).collect()
}
