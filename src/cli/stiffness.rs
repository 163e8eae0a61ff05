//! `optimize stiffness`: the stiffness model and how well it fits.

use super::{Failure, print, print_json};
use crate::report::stiffness;
use crate::session::{DEFAULT_FINGER, StiffnessRequest};
use crate::study::write_file;
use clap::Args;
use std::path::PathBuf;

/// Show the stiffness model.
#[derive(Debug, Clone, Args)]
pub struct Arguments {
    /// Your own stiffness measurements in place of the shipped ones
    #[arg(long, value_name = "FILE.csv")]
    stiffness_data: Option<String>,
    /// Finger that was measured: finray9, or the path of a finger file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_FINGER)]
    finger: String,
    /// Also write a plot of the data, the model and its uncertainty
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { stiffness_data, finger, .. } = arguments.clone();
    let model = StiffnessRequest { stiffness_data, finger }.model()?;
    if let Some(path) = &arguments.svg {
        let svg = stiffness::svg(&model).map_err(|error| Failure::running(error.to_string()))?;
        write_file(path, &svg)?;
    }
    if arguments.json {
        return print_json(&stiffness::json(&model));
    }
    print(&stiffness::table(&model))
}
