//! `optimize stiffness`: the stiffness model and how well it fits.

use super::{Failure, print, print_json};
use crate::session::StiffnessRequest;
use clap::Args;
use report::stiffness;
use std::path::PathBuf;
use study::write_file;

/// Show the stiffness model.
#[derive(Debug, Clone, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: StiffnessRequest,
    /// Also write a plot of the data, the model and its uncertainty
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let model = arguments.request.model()?;
    if let Some(path) = &arguments.svg {
        write_file(path, &stiffness::svg(&model)?)?;
    }
    if arguments.json {
        return print_json(&stiffness::json(&model));
    }
    print(&stiffness::table(&model))
}
