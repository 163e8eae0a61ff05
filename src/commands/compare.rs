//! `optimize compare`: studies of the same problem side by side.

use crate::command;
use crate::context::Context;
use crate::failure::Failure;
use report::compare::{Comparison, TOLERANCE_MM, compare, page, svg};
use report::text_table;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;
use study::{StudyRecord, write_file};

/// Compare optimizers over studies of the same task and objective
#[derive(Debug, clap::Args)]
#[command(
    display_order = 15,
    after_help = "Example: optimize compare results/usb-gp-seed0 results/usb-sobol-seed0"
)]
pub struct Request {
    /// Folders of the studies; several seeds of an optimizer give median and quartiles
    #[arg(required = true, value_name = "DIR")]
    pub dirs: Vec<PathBuf>,
    /// Draw the best value so far of each optimizer
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
    /// Write table and picture as a page
    #[arg(long, value_name = "FILE.html")]
    pub html: Option<PathBuf>,
}

/// Studies side by side.
#[derive(Serialize)]
#[serde(transparent)]
pub struct Compared(Comparison);

impl command::Request for Request {
    type Response = Compared;

    fn run(&self, _context: &Context<'_>) -> Result<Compared, Failure> {
        let load = |dir: &PathBuf| Ok((dir.display().to_string(), StudyRecord::load(dir)?));
        let studies = self.dirs.iter().map(load).collect::<Result<Vec<_>, Failure>>()?;
        let comparison = compare(&studies).map_err(Failure::usage)?;
        if let Some(file) = &self.svg {
            write_file(file, &svg(&comparison)?)?;
        }
        if let Some(file) = &self.html {
            write_file(file, &page(&comparison)?)?;
        }
        Ok(Compared(comparison))
    }
}

impl command::Response for Compared {
    fn picture(&self) -> Result<Option<String>, Failure> {
        Ok(Some(svg(&self.0)?))
    }
}

impl fmt::Display for Compared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Compared(comparison) = self;
        let best = comparison.best_known_mm;
        let rows = comparison.groups.iter().map(|group| {
            let number = |n: Option<f64>| n.map_or("-".to_owned(), |n| format!("{n:.1}"));
            let [low, median, high] = group.evaluations_to_target.all().map(number);
            let (batch, studies) = (group.batch.to_string(), group.studies.to_string());
            [group.optimizer.clone(), batch, studies, group.reached.to_string(), low, median, high]
        });
        let head = ["optimizer", "batch", "studies", "reached", "25 %", "median", "75 %"];
        write!(
            f,
            "{}, {}: best known {best:.1} mm\nevaluations to {:.1} mm ({TOLERANCE_MM} mm below the best known)\n\n{}",
            comparison.task,
            comparison.objective,
            comparison.target_mm,
            text_table(1, head, rows)
        )
    }
}
