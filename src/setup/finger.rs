//! Finger of a trial or an evaluation.

use super::Setup;
use crate::{Failure, layout};
use connector::check::{Problem, wrong_units};
use input::shown;
use input::units::{MM, N_PER_MM};
use input::wrong_unit;
use insertion::finger::model::{CentreSource, RCC_KEY};
use insertion::{
    DENSITY_KEY, DIRECTION_KEY, Design, Evaluator, FingerModelKind, Prediction, Priors, Scenario,
};
use parameters::numbers;
use report::answer::lines;
use serde::{Serialize, Serializer};
use serde_json::json;

/// Parses a stiffness, N/mm.
fn stiffness(text: &str) -> Result<f64, String> {
    let n_per_mm = text.parse().unwrap_or(f64::NAN);
    numbers::problem("stiffness_compliance_n_per_mm", n_per_mm).map_or(Ok(n_per_mm), Err)
}

/// Parses a setting, `KEY=VALUE`.
pub(crate) fn setting(text: &str) -> Result<(String, f64), String> {
    match text.split_once('=').map(|(key, value)| (key.trim(), value.trim().parse())) {
        Some((key, Ok(value))) if !key.is_empty() => Ok((key.to_owned(), value)),
        _ => Err("a setting is KEY=NUMBER, as in task.strategy.tilt_deg=8".to_owned()),
    }
}

/// Infill of a finger.
#[derive(Debug, Clone, Copy, Default, PartialEq, clap::Args)]
pub struct InfillRequest {
    /// Infill density, percent
    #[arg(long, value_name = "PERCENT")]
    pub density: Option<f64>,
    /// Infill direction, degrees
    #[arg(long, value_name = "DEG")]
    pub direction: Option<f64>,
}

impl InfillRequest {
    /// Returns the infill of this density, percent, and direction, degrees.
    pub fn of(density: f64, direction: f64) -> Self {
        InfillRequest { density: Some(density), direction: Some(direction) }
    }

    /// Returns the density, percent, and the direction, degrees, which must both be given; `or` names in the error what
    /// could be given instead.
    ///
    /// # Errors
    /// If one of them is missing, or the density is out of bounds.
    pub fn required(self, or: &str) -> Result<[f64; 2], Failure> {
        let (Some(density), Some(direction)) = (self.density, self.direction) else {
            return Err(Failure::usage(format!("give --density and --direction{or}")));
        };
        match numbers::problem(DENSITY_KEY, density) {
            Some(problem) => Err(Failure::usage(format!("--density: {problem}"))),
            None => Ok([density, direction]),
        }
    }
}

/// Finger, by its infill or by its stiffness.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct FingerRequest {
    /// Infill of the finger.
    #[command(flatten)]
    pub infill: InfillRequest,
    /// Stiffness in the compliance direction, N/mm: bypasses the surrogate
    #[arg(long, value_name = "K", requires = "stiffness_assembly", value_parser = stiffness)]
    pub stiffness_compliance: Option<f64>,
    /// Stiffness in the direction of assembly, N/mm: bypasses the surrogate
    #[arg(long, value_name = "K", requires = "stiffness_compliance", value_parser = stiffness)]
    pub stiffness_assembly: Option<f64>,
    /// A number of the task or the finger, as in spaces/codesign.toml; may be given several times
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, f64)>,
}

/// Returns the usage of a command that takes a finger by its infill or by its stiffness.
pub(crate) fn usage(command: &str) -> String {
    let task = format!("optimize {command} [OPTIONS] --task <NAME>");
    let infill = format!("{task} --density <PERCENT> --direction <DEG>");
    format!("{infill}\n       {task} --stiffness-compliance <K> --stiffness-assembly <K>")
}

/// Finger on a task, with the source of its stiffness.
pub struct ChosenFinger {
    /// Task, finger and robot, ready for simulation.
    pub scenario: Scenario,
    /// Cell (robot, friction and other parameters of an installation), if one is given.
    pub cell: Option<Priors>,
    /// Finger model: source of the stiffnesses that were not measured.
    pub finger_model: FingerModelKind,
    /// Infill and settings; empty if only a stiffness is given.
    pub design: Design,
    /// Settings other than the infill.
    pub set: Design,
    /// Whether the stiffness was given, not predicted.
    pub given: bool,
}

impl FingerRequest {
    /// Returns the finger on the task of a setup, and checks that its settings are in the units of their keys.
    pub(crate) fn choose(&self, setup: &Setup) -> Result<ChosenFinger, Failure> {
        let chosen = self.choose_with(setup, &setup.evaluator)?;
        if !chosen.set.0.is_empty() {
            let known = wrong_units(&setup.only_task()?.task);
            let found = wrong_units(&chosen.scenario.task)
                .into_iter()
                .find(|problem| !known.contains(problem));
            if let Some(Problem { key, problem, remedy }) = found {
                return Err(Failure::usage(format!("--set: task.{key}: {problem}; {remedy}")));
            }
        }
        Ok(chosen)
    }

    /// Returns the finger on the task of a setup, with the finger model and stiffness model of an evaluator.
    pub(crate) fn choose_with(
        &self,
        setup: &Setup,
        evaluator: &Evaluator,
    ) -> Result<ChosenFinger, Failure> {
        let template = setup.only_task()?;
        let mut design = Design::default();
        for (flag, key, value) in [
            ("--density", DENSITY_KEY, self.infill.density),
            ("--direction", DIRECTION_KEY, self.infill.direction),
        ] {
            if let Some(value) = value {
                check(setup, flag, key, value)?;
                design.0.insert(key.to_owned(), value);
            }
        }
        let mut set = Design::default();
        for (key, value) in &self.set {
            if [DENSITY_KEY, DIRECTION_KEY].contains(&key.as_str()) {
                return Err(Failure::usage(format!(
                    "--set {key}: give the infill with --density and --direction"
                )));
            }
            if setup.space.parameters.iter().any(|parameter| parameter.key == *key) {
                check(setup, "--set", key, *value)?;
            }
            if set.0.insert(key.clone(), *value).is_some() {
                return Err(Failure::usage(format!("--set {key}: given twice")));
            }
        }
        design.0.extend(set.0.clone());
        let stiffness = self.stiffness_compliance.zip(self.stiffness_assembly);
        let given = stiffness.is_some();
        let stiffness = match stiffness {
            Some(_) if evaluator.fingers.kind() == FingerModelKind::Computed => {
                return Err(Failure::usage(
                    "--stiffness-compliance and --stiffness-assembly need the finger model `paper`; \
                     --finger-model computed takes --density and --direction only",
                ));
            }
            Some((compliance, assembly)) => {
                Prediction::exact(compliance * N_PER_MM, assembly * N_PER_MM)
            }
            None => {
                self.infill.required(", or --stiffness-compliance and --stiffness-assembly")?;
                evaluator.predict(&design)?
            }
        };
        let scenario = evaluator.scenario(template, &design, stiffness)?;
        let (cell, finger_model) = (evaluator.cell.clone(), evaluator.fingers.kind());
        Ok(ChosenFinger { scenario, cell, finger_model, design, set, given })
    }
}

/// Checks that a value lies within the bounds of its key in the space.
fn check(setup: &Setup, flag: &str, key: &str, value: f64) -> Result<(), Failure> {
    let parameters = &setup.space.parameters;
    match parameters.iter().find(|parameter| parameter.key == key) {
        // NaN is outside.
        Some(parameter) if (parameter.low..=parameter.high).contains(&value) => Ok(()),
        Some(parameter) => {
            let (unit, bounds) = (parameter.key.unit(), [parameter.low, parameter.high]);
            let other = wrong_unit::other(unit, value, bounds);
            let other = other.map_or(String::new(), |other| format!("; {other}"));
            let ([low, high], space) = (bounds, &setup.space.name);
            Err(Failure::usage(format!(
                "{flag} {}: {key} must lie between {low} and {high}{unit} in the space `{space}`{other}",
                shown(value),
            )))
        }
        None => {
            Err(Failure::usage(format!("{flag}: the space `{}` has no {key}", setup.space.name)))
        }
    }
}

impl Serialize for ChosenFinger {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Scenario { task, finger, stiffness, robot, .. } = &self.scenario;
        let mut subject = json!({
            "task": task.name,
            "robot": robot.name,
            "cell": self.cell.as_ref().map(|cell| &cell.name),
            "infill_density_percent": self.design.get(DENSITY_KEY),
            "infill_direction_deg": self.design.get(DIRECTION_KEY),
            "set": self.set,
            "finger_model": self.finger_model,
            "rcc_mm": finger.rcc / MM,
            "rcc_from": self.scenario.centre_source(),
            "tilting_nm_per_rad": finger.rotation[0],
            "stiffness": stiffness,
        });
        if let Some(cell) = &self.cell {
            subject["cell_applied"] = cell.of(&task.name).map(|row| &*row.path).collect();
            subject["cell_not_applied"] = json!(cell.not_applied(&task.name));
        }
        subject.serialize(serializer)
    }
}

impl ChosenFinger {
    /// Returns task, robot, design, stiffness and finger model as lines.
    pub fn text(&self) -> String {
        let Scenario { task, robot, stiffness, .. } = &self.scenario;
        let stiffness = match self.given {
            false => layout::lines(lines::stiffness(stiffness)),
            true => format!(
                "stiffness     compliance {} N/mm, assembly {} N/mm, as given\n",
                stiffness.compliance.mean / N_PER_MM,
                stiffness.assembly.mean / N_PER_MM
            ),
        };
        let finger = self.model_text();
        let design = match self.design.0.is_empty() {
            true => String::new(),
            false => format!("design        {}\n", self.design.labelled()),
        };
        let cell = self.cell.as_ref();
        let of_cell = cell.map_or(String::new(), |cell| format!(", of the cell `{}`", cell.name));
        let subject =
            format!("task          {}\nrobot         {}{of_cell}\n", task.name, robot.name);
        let radians = self.design.get(DIRECTION_KEY).and_then(wrong_unit::direction);
        let radians = radians.map(|radians| radians.join(" "));
        let remarks = cell.and_then(|cell| cell.remark(&task.name));
        let remarks = remarks.into_iter().chain(robot.remark()).chain(radians);
        let remarks: String = remarks.map(|remark| format!("warning       {remark}\n")).collect();
        format!("{subject}{design}{stiffness}{finger}{remarks}")
    }

    /// Returns the values computed by the finger model as text; empty for the model of the paper.
    fn model_text(&self) -> String {
        let Scenario { finger, .. } = &self.scenario;
        if self.finger_model == FingerModelKind::Paper {
            return String::new();
        }
        let (below, ahead) = (finger.rcc / MM, finger.ahead / MM);
        let given = match self.scenario.centre_source() {
            CentreSource::FingerModel => String::new(),
            CentreSource::Task => ", given by the task file, not computed".to_owned(),
            CentreSource::Design => format!(", given by {RCC_KEY}, not computed"),
        };
        format!(
            "finger        computed: tilting {:.2} N m/rad, remote centre {ahead:.1} mm in front of \
             the pad\n              and {below:.1} mm below the grasp point{given}\n",
            finger.rotation[0]
        )
    }
}
