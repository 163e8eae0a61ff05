//! `optimize stiffness`: the stiffness model and how well it fits.

use super::setup::{stiffness_data, surrogate};
use super::summary::{self, stiffness_json};
use super::{Failure, print, print_json};
use clap::Args;
use finger_opt::space::Design;
use serde_json::json;

/// Show the stiffness model.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Your own stiffness measurements in place of the shipped ones
    #[arg(long, value_name = "FILE.csv")]
    stiffness_data: Option<String>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command. SEAM: the leave-one-out table and the plot go in here.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let data = stiffness_data(arguments.stiffness_data.as_deref())?;
    let surrogate = surrogate(&data)?;
    let designs = [(10.0, 0.0), (20.0, 20.0), (30.0, 40.0)];
    let predictions = designs.map(|(density, direction)| {
        let design = Design::infill(density, direction);
        let prediction = surrogate.predict(&design);
        (design, prediction)
    });
    if arguments.json {
        let of = predictions
            .iter()
            .map(|(design, p)| json!({"design": design, "stiffness": stiffness_json(p)}));
        return print_json(&json!({"predictions": of.collect::<Vec<_>>()}));
    }
    let lines = predictions
        .iter()
        .map(|(design, prediction)| format!("{design}\n{}\n", summary::stiffness(prediction)));
    print(&lines.collect::<String>())
}
