//! `optimize compare`: studies of the same problem side by side.

use crate::{Context, Failure, Output, command};
use report::compare::{compare, svg, text};
use std::path::PathBuf;
use study::StudyRecord;

/// Compare optimizers over studies of the same task and objective
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: optimize compare results/usb-gp-seed0 results/usb-sobol-seed0")]
pub struct Request {
    /// Folders of the studies; several seeds of an optimizer give median and quartiles
    #[arg(required = true, value_name = "DIR")]
    pub dirs: Vec<PathBuf>,
    /// Draw the best value so far of each optimizer
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

impl command::Request for Request {
    fn run(&self, _context: &Context<'_>) -> Result<Output, Failure> {
        let load = |dir: &PathBuf| Ok((dir.display().to_string(), StudyRecord::load(dir)?));
        let studies = self.dirs.iter().map(load).collect::<Result<Vec<_>, Failure>>()?;
        let comparison = compare(&studies).map_err(Failure::usage)?;
        let picture = svg(&comparison)?;
        Output::new(text(&comparison), comparison).drawn(picture, self.svg.as_ref())
    }
}
