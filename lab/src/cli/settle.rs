//! `lab settle`: how searches without a budget end on recorded landscapes.

use super::optimizers::landscape;
use super::{Failure, print};
use crate::problems::{settle, settled_markdown};
use clap::Args;
use std::path::PathBuf;

/// Count the evaluations after which a search settles on recorded landscapes
///
/// Searches each landscape with `gp` until no gain is expected, and confirms the widest designs by
/// the firm ranges that the landscape holds. Prints Markdown.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Recorded landscape, as results/reference/landscapes/usb.csv; may be repeated
    #[arg(long, value_name = "FILE.csv", required = true)]
    landscape: Vec<PathBuf>,
    /// Searches of each landscape, with seeds from 0
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    seeds: u64,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut text = "| landscape | seed | evaluations | settled | repeated | walked | firm range, mm | short of the best, mm |\n\
                    | --- | --- | --- | --- | --- | --- | --- | --- |\n"
        .to_owned();
    for file in &arguments.landscape {
        let (name, landscape) = landscape(file)?;
        let found = settle(&landscape, arguments.seeds);
        text += &settled_markdown(&name, landscape.best_firm(), &found);
    }
    print(&text)
}
