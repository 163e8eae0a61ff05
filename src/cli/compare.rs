//! `optimize compare DIR..`: studies of the same problem side by side.

use super::{Failure, print, print_json};
use clap::Args;
use report::compare::{Comparison, TOLERANCE_MM, compare, page, svg};
use serde_json::json;
use std::path::PathBuf;
use study::{StudyRecord, write_file};

/// Compare optimizers over studies of the same task and objective.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folders of the studies; several seeds of an optimizer give its median and quartiles
    #[arg(required = true, value_name = "DIR")]
    dirs: Vec<PathBuf>,
    /// Draw the best so far of each optimizer
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Write table and picture as a page
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// The studies of these folders side by side.
pub fn compared(dirs: &[PathBuf]) -> Result<Comparison, Failure> {
    let load = |dir: &PathBuf| Ok((dir.display().to_string(), StudyRecord::load(dir)?));
    let studies = dirs.iter().map(load).collect::<Result<Vec<_>, Failure>>()?;
    compare(&studies).map_err(Failure::usage)
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let comparison = compared(&arguments.dirs)?;
    if let Some(file) = &arguments.svg {
        write_file(file, &svg(&comparison)?)?;
    }
    if let Some(file) = &arguments.html {
        write_file(file, &page(&comparison)?)?;
    }
    if arguments.json {
        return print_json(&json!(comparison));
    }
    print(&table(&comparison))
}

fn table(comparison: &Comparison) -> String {
    let best = comparison.best_known_mm;
    let mut text = format!(
        "{}, {}: best known {best:.1} mm\nevaluations to {:.1} mm ({TOLERANCE_MM} mm below the best known)\n\n\
         {:<14} {:>5} {:>8} {:>8} {:>8} {:>8} {:>8}\n",
        comparison.task,
        comparison.objective,
        comparison.target_mm,
        "optimizer",
        "batch",
        "studies",
        "reached",
        "25 %",
        "median",
        "75 %"
    );
    for group in &comparison.groups {
        let number = |n: Option<f64>| n.map_or("-".to_owned(), |n| format!("{n:.1}"));
        let [low, median, high] = group.evaluations_to_target.all().map(number);
        text.push_str(&format!(
            "{:<14} {:>5} {:>8} {:>8} {low:>8} {median:>8} {high:>8}\n",
            group.optimizer, group.batch, group.studies, group.reached,
        ));
    }
    text
}
