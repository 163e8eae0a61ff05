//! `optimize stiffness`: the stiffness model and how well it fits.

use super::setup::{DEFAULT_FINGER, printed_finger, stiffness_data, surrogate};
use super::{Failure, print, print_json};
use crate::report::{stiffness, stiffness_means};
use crate::study::write_file;
use crate::surrogate::{Means, Model, means};
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Show the stiffness model.
#[derive(Debug, Args)]
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
    let model = arguments.model()?;
    if let Some(path) = &arguments.svg {
        let svg = stiffness::svg(&model).map_err(|error| Failure::running(error.to_string()))?;
        write_file(path, &svg)?;
    }
    if arguments.json {
        return print_json(&as_json(&model)?);
    }
    let means = compared(&model)?;
    let text = means.as_ref().map_or(format!("\n{}.\n", left_out()), stiffness_means::text);
    print(&(stiffness::table(&model) + &text))
}

/// Most fingers that are computed from their ribs and whose means are compared: that takes a third of a
/// second of processor each, and more than that where there are many.
const MOST_COMPUTED: usize = 25;

fn left_out() -> String {
    format!("Left out: fingers by their ribs and means compared, above {MOST_COMPUTED} designs")
}

/// What is computed of the fingers, if they are few enough.
fn compared(model: &Model) -> Result<Option<Means>, Failure> {
    let few = model.measurements().len() <= MOST_COMPUTED;
    few.then(|| means(model).map_err(Failure::input)).transpose()
}

impl Arguments {
    /// The model of the data that the arguments name.
    fn model(&self) -> Result<Model, Failure> {
        let finger = printed_finger(&self.finger)?;
        let data = stiffness_data(self.stiffness_data.as_deref(), &finger)?;
        surrogate(&data, &finger)
    }

    /// What `--json` prints.
    pub fn json(&self) -> Result<Value, Failure> {
        as_json(&self.model()?)
    }
}

fn as_json(model: &Model) -> Result<Value, Failure> {
    let means = compared(model)?;
    let mut value = stiffness::json(model);
    if let Some(keys) = value.as_object_mut() {
        match means {
            Some(means) => keys.extend(stiffness_means::json(&means)),
            None => {
                let none = ["means", "preferred", "fingers"].map(|key| (key.to_owned(), json!([])));
                keys.extend(none);
                keys.extend([("left_out".to_owned(), left_out().into())]);
            }
        }
    }
    Ok(value)
}
