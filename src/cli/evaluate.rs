//! `optimize evaluate`: the tolerance window of one finger.

use super::setup::{Setup, SetupArguments};
use super::summary::{self, evaluation_json, merge, stiffness_json};
use super::{Failure, print, print_json};
use clap::Args;
use finger_opt::finger::Finger;
use finger_opt::space::{DENSITY_KEY, DIRECTION_KEY, Design};
use finger_opt::surrogate::Prediction;
use finger_opt::tolerance::{self, Search};
use finger_opt::units::N_PER_MM;
use serde_json::{Value, json};
use std::time::Instant;

/// Measure one finger.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    setup: SetupArguments,
    #[command(flatten)]
    finger: FingerArguments,
    /// Look every 0.5 mm and bisect: a third of the trials, but it may step over gaps
    #[arg(long)]
    strides: bool,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Which finger.
#[derive(Debug, Clone, Args)]
pub struct FingerArguments {
    /// Infill density, percent
    #[arg(
        long,
        value_name = "PERCENT",
        required_unless_present = "stiffness_compliance",
        allow_negative_numbers = true
    )]
    density: Option<f64>,
    /// Infill direction, degrees
    #[arg(
        long,
        value_name = "DEG",
        required_unless_present = "stiffness_compliance",
        allow_negative_numbers = true
    )]
    direction: Option<f64>,
    /// Stiffness in the compliance direction, N/mm: bypasses the surrogate
    #[arg(long, value_name = "K", requires = "stiffness_assembly", value_parser = stiffness,
          allow_negative_numbers = true)]
    stiffness_compliance: Option<f64>,
    /// Stiffness in the direction of assembly, N/mm: bypasses the surrogate
    #[arg(long, value_name = "K", requires = "stiffness_compliance", value_parser = stiffness,
          allow_negative_numbers = true)]
    stiffness_assembly: Option<f64>,
}

/// A finger and where its stiffness comes from.
pub struct Chosen {
    pub finger: Finger,
    /// `None` if the stiffness was given.
    pub prediction: Option<Prediction>,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let setup = Setup::from_arguments(&arguments.setup)?;
    let chosen = arguments.finger.choose(&setup)?;
    let clock = Instant::now();
    let search = if arguments.strides { Search::Strides } else { Search::Walk };
    let evaluation = tolerance::evaluate(&*setup.rig, &chosen.finger, search);
    let wall_s = clock.elapsed().as_secs_f64();
    if arguments.json {
        let mut fields = chosen.json(&setup, &arguments.finger);
        merge(&mut fields, evaluation_json(&evaluation));
        merge(&mut fields, json!({"wall_s": wall_s}));
        return print_json(&fields);
    }
    let counts = evaluation.failure_counts;
    print(&format!(
        "task          {}\n{}\nrange         {:.1} mm\n{}\nfailures      {} of class 1, {} of 2, {} of 3, \
         {} of 4, {} diverged in {} trials\npeak force    {:.1} N\ntime          {wall_s:.1} s\n",
        setup.task.name,
        chosen.stiffness_line(),
        evaluation.window.range_mm(),
        summary::window(&evaluation),
        counts[0],
        counts[1],
        counts[2],
        counts[3],
        evaluation.diverged,
        evaluation.trials,
        evaluation.peak_force_n,
    ))
}

impl FingerArguments {
    /// The finger, checked against the space.
    pub fn choose(&self, setup: &Setup) -> Result<Chosen, Failure> {
        for (flag, key, value) in [
            ("--density", DENSITY_KEY, self.density),
            ("--direction", DIRECTION_KEY, self.direction),
        ] {
            if let Some(value) = value {
                check(setup, flag, key, value)?;
            }
        }
        if let (Some(compliance), Some(assembly)) =
            (self.stiffness_compliance, self.stiffness_assembly)
        {
            let finger = Finger::new(compliance * N_PER_MM, assembly * N_PER_MM);
            return Ok(Chosen { finger, prediction: None });
        }
        let (Some(density), Some(direction)) = (self.density, self.direction) else {
            return Err(Failure::usage("give --density and --direction"));
        };
        let prediction = setup.surrogate.predict(&Design::infill(density, direction));
        let finger = Finger::new(prediction.compliance.mean, prediction.assembly.mean);
        Ok(Chosen { finger, prediction: Some(prediction) })
    }
}

impl Chosen {
    /// The keys that say what was measured.
    pub fn json(&self, setup: &Setup, arguments: &FingerArguments) -> Value {
        json!({
            "task": setup.task.name,
            "robot": setup.robot.name,
            "density_percent": arguments.density,
            "direction_deg": arguments.direction,
            "stiffness": match &self.prediction {
                Some(prediction) => stiffness_json(prediction),
                None => json!({
                    "compliance_n_per_mm": self.finger.compliance / N_PER_MM,
                    "assembly_n_per_mm": self.finger.assembly / N_PER_MM,
                }),
            },
        })
    }

    /// The stiffness as one line of text.
    pub fn stiffness_line(&self) -> String {
        let (compliance, assembly) = (self.finger.compliance, self.finger.assembly);
        match &self.prediction {
            Some(prediction) => summary::stiffness(prediction),
            None => format!(
                "stiffness     compliance {} N/mm, assembly {} N/mm, as given",
                compliance / N_PER_MM,
                assembly / N_PER_MM
            ),
        }
    }
}

/// A value must lie within the bounds its key has in the space.
fn check(setup: &Setup, flag: &str, key: &str, value: f64) -> Result<(), Failure> {
    let parameters = setup.space.parameters();
    match parameters.iter().find(|parameter| parameter.key == key) {
        // Written so that a NaN is outside.
        Some(parameter) if (parameter.low..=parameter.high).contains(&value) => Ok(()),
        Some(parameter) => Err(Failure::usage(format!(
            "{flag} {value}: {key} must lie between {} and {} in the space `{}`",
            parameter.low,
            parameter.high,
            setup.space.name()
        ))),
        None => {
            Err(Failure::usage(format!("{flag}: the space `{}` has no {key}", setup.space.name())))
        }
    }
}

fn stiffness(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("a stiffness is a number above 0, in N/mm".to_owned()),
    }
}
