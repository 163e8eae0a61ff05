//! Which finger and task a trial or an evaluation is of.

use super::Failure;
use super::setup::Setup;
use super::words;
use clap::Args;
use input::shown;
use input::units::{MM, N_PER_MM};
use insertion::evaluation::evaluator::{Evaluator, Specimen};
use insertion::finger::model::{CentreFrom, FingerModelKind, RCC_KEY};
use insertion::space::{DENSITY_KEY, DIRECTION_KEY, Design};
use insertion::surrogate::Prediction;
use serde_json::{Value, json};

/// Which finger, and on what task.
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
    /// A number of the task or the finger, as in spaces/codesign.toml; may be given several times
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    set: Vec<(String, f64)>,
}

/// A finger on a task, and where its stiffness comes from.
pub struct Chosen {
    pub specimen: Specimen,
    /// All that names the design: infill and what was set; empty for a stiffness alone.
    pub design: Design,
    /// What was set beside the infill.
    pub set: Design,
    /// Whether the stiffness was given, not predicted.
    pub given: bool,
}

impl FingerArguments {
    /// Whether the finger is given by two springs, not by its infill.
    pub fn springs_are_given(&self) -> bool {
        self.stiffness_compliance.is_some() || self.stiffness_assembly.is_some()
    }

    /// The finger, checked against the space.
    pub fn choose(&self, setup: &Setup) -> Result<Chosen, Failure> {
        self.by(setup, &setup.evaluator)
    }

    /// The same finger by the models of another evaluator of the same setup.
    pub fn specimen(&self, setup: &Setup, by: &Evaluator) -> Result<Specimen, Failure> {
        Ok(self.by(setup, by)?.specimen)
    }

    fn by(&self, setup: &Setup, evaluator: &Evaluator) -> Result<Chosen, Failure> {
        let template = setup.only_task()?;
        for (flag, key, value) in [
            ("--density", DENSITY_KEY, self.density),
            ("--direction", DIRECTION_KEY, self.direction),
        ] {
            if let Some(value) = value {
                check(setup, flag, key, value)?;
            }
        }
        let set = self.settings(setup)?;
        let mut design = set.clone();
        design.0.extend(self.density.map(|density| (DENSITY_KEY.to_owned(), density)));
        design.0.extend(self.direction.map(|direction| (DIRECTION_KEY.to_owned(), direction)));
        let (stiffness, given) = match (self.stiffness_compliance, self.stiffness_assembly) {
            (Some(_), Some(_)) if evaluator.fingers.kind() == FingerModelKind::Computed => {
                return Err(Failure::usage(
                    "--stiffness-compliance and --stiffness-assembly are springs of the finger \
                     model `paper`; --finger-model computed needs --density and --direction alone",
                ));
            }
            (Some(compliance), Some(assembly)) => {
                (Prediction::exact(compliance * N_PER_MM, assembly * N_PER_MM), true)
            }
            _ if self.density.is_some() && self.direction.is_some() => {
                (evaluator.predict(&design).map_err(Failure::input)?, false)
            }
            _ => return Err(Failure::usage("give --density and --direction")),
        };
        let specimen = evaluator.specimen(template, &design, stiffness).map_err(Failure::input)?;
        Ok(Chosen { specimen, design, set, given })
    }

    /// What is set beside the infill; a key of the space must keep to its bounds there.
    fn settings(&self, setup: &Setup) -> Result<Design, Failure> {
        let mut set = Design::default();
        for (key, value) in &self.set {
            if [DENSITY_KEY, DIRECTION_KEY].contains(&key.as_str()) {
                return Err(Failure::usage(format!(
                    "--set {key}: give the infill by --density and --direction"
                )));
            }
            if setup.space.parameters().iter().any(|parameter| parameter.key == *key) {
                check(setup, "--set", key, *value)?;
            }
            if set.0.insert(key.clone(), *value).is_some() {
                return Err(Failure::usage(format!("--set {key}: is given twice")));
            }
        }
        Ok(set)
    }
}

impl Chosen {
    /// The keys that say what was measured.
    pub fn json(&self, setup: &Setup, arguments: &FingerArguments) -> Value {
        json!({
            "task": self.specimen.task.name,
            "robot": setup.evaluator.robot.name,
            "infill_density_percent": arguments.density,
            "infill_direction_deg": arguments.direction,
            "set": self.set,
            "finger_model": setup.evaluator.fingers.kind().name(),
            "rcc_mm": self.specimen.finger.rcc / MM,
            "rcc_from": from_word(self.specimen.centre),
            "tilting_nm_per_rad": self.specimen.finger.rotation[0],
            "stiffness": self.specimen.stiffness,
        })
    }

    /// What was set, and the stiffness, a line each.
    pub fn text(&self, setup: &Setup) -> String {
        let stiffness = &self.specimen.stiffness;
        let stiffness = match self.given {
            false => words::stiffness(stiffness),
            true => format!(
                "stiffness     compliance {} N/mm, assembly {} N/mm, as given",
                stiffness.compliance.mean / N_PER_MM,
                stiffness.assembly.mean / N_PER_MM
            ),
        };
        let finger = self.finger_text(setup.evaluator.fingers.kind());
        let design = match self.design.0.is_empty() {
            true => String::new(),
            false => format!("design        {}\n", self.design.labelled()),
        };
        format!("{design}{stiffness}{finger}")
    }

    /// What the finger model made of it, if it is not the paper's; a line that begins anew.
    fn finger_text(&self, kind: FingerModelKind) -> String {
        let Specimen { finger, centre, .. } = &self.specimen;
        if kind == FingerModelKind::Paper {
            return String::new();
        }
        let (below, ahead) = (finger.rcc / MM, finger.ahead / MM);
        let given = match centre {
            CentreFrom::Model => String::new(),
            CentreFrom::TaskFile => ", as the task file says, not computed".to_owned(),
            CentreFrom::Design => format!(", as {RCC_KEY} says, not computed"),
        };
        format!(
            "\nfinger        computed: tilting {:.2} N m/rad, remote centre {ahead:.1} mm in front of \
             the pad\n              and {below:.1} mm below the grasp point{given}",
            finger.rotation[0]
        )
    }
}

fn from_word(centre: CentreFrom) -> &'static str {
    match centre {
        CentreFrom::Model => "finger-model",
        CentreFrom::TaskFile => "task",
        CentreFrom::Design => "design",
    }
}

/// A value must lie within the bounds its key has in the space.
fn check(setup: &Setup, flag: &str, key: &str, value: f64) -> Result<(), Failure> {
    let parameters = setup.space.parameters();
    match parameters.iter().find(|parameter| parameter.key == key) {
        // Written so that a NaN is outside.
        Some(parameter) if (parameter.low..=parameter.high).contains(&value) => Ok(()),
        Some(parameter) => Err(Failure::usage(format!(
            "{flag} {}: {key} must lie between {} and {} in the space `{}`",
            shown(value),
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
        Ok(value) if (1e-6..=1e6).contains(&value) => Ok(value),
        _ => Err("a stiffness is a number above 0, 1e-6 to 1e6, in N/mm".to_owned()),
    }
}

pub fn setting(text: &str) -> Result<(String, f64), String> {
    let parts = text.split_once('=').map(|(key, value)| (key.trim(), value.trim().parse()));
    match parts {
        Some((key, Ok(value))) if !key.is_empty() => Ok((key.to_owned(), value)),
        _ => Err("a setting is KEY=NUMBER, as in task.strategy.tilt_deg=8".to_owned()),
    }
}
