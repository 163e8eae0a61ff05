//! `lab optimizers`: evaluations that the optimizers need on problems with known optima.

use super::{Failure, print};
use crate::problems::{Function, GridProblem, Landscape, csv, markdown, on_function, on_grid};
use ask_tell::OptimizerKind;
use clap::{Args, ValueEnum};
use input::shipped;
use std::path::{Path, PathBuf};
use study::write_file;

/// Count the evaluations that the optimizers need on problems with known optima
///
/// Four functions of two and five variables are searched by CMA-ES to 1e-8; Branin and
/// Hartmann-6, on 1001 levels per axis, to 1 % of their range (limit 200 and 60 evaluations);
/// recorded landscapes to within 0.1 mm of their best design (limit 100). Prints Markdown.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Runs of each optimizer on each problem, with seeds from 0
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    seeds: u64,
    /// Functions, separated by commas; all of them if no landscape is given
    #[arg(long, value_name = "NAME,..", value_delimiter = ',', value_enum)]
    functions: Option<Vec<Function>>,
    /// Recorded landscape, as results/reference/landscapes/usb.csv; may be repeated
    #[arg(long, value_name = "FILE.csv")]
    landscape: Vec<PathBuf>,
    /// Optimizers, separated by commas
    #[arg(long, value_name = "NAME,..", value_delimiter = ',', default_values_t = OptimizerKind::all())]
    optimizers: Vec<OptimizerKind>,
    /// Write every run as CSV
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let landscapes =
        arguments.landscape.iter().map(|file| problem(file)).collect::<Result<Vec<_>, _>>()?;
    let all = if landscapes.is_empty() { Function::value_variants() } else { &[] };
    let functions = arguments.functions.as_deref().unwrap_or(all);
    let (methods, seeds) = (&arguments.optimizers, arguments.seeds);
    let runs = functions.iter().flat_map(|function| on_function(*function, methods, seeds));
    let more = landscapes.iter().flat_map(|landscape| on_grid(landscape, methods, seeds));
    let runs: Vec<_> = runs.chain(more).collect();
    if let Some(file) = &arguments.csv {
        write_file(file, &csv(&runs))?;
    }
    print(&markdown(&runs))
}

fn problem(file: &Path) -> Result<GridProblem, Failure> {
    let (name, landscape) = landscape(file)?;
    Ok(GridProblem::of_landscape(&name, landscape))
}

/// A recorded landscape, and its name.
pub(super) fn landscape(file: &Path) -> Result<(String, Landscape), Failure> {
    let path = file.display().to_string();
    let source = shipped::resolve("landscape", &[], &path).map_err(Failure::input)?;
    let landscape = Landscape::parse(&source.text, &source.file).map_err(Failure::input)?;
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok((name, landscape))
}
