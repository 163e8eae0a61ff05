//! Application of parameter values to task, finger and robot.

use super::Priors;
use crate::finger::file::is_shape;
use crate::robot::Drive;
use crate::trial::Conditions;
use crate::{Design, DesignError, Evaluator, FingerSource, Prediction, Robot, Scenario, Template};
use input::numbers::{DESIGN, unknown_path};
use input::units::{MM, N_PER_MM};
use input::{Check, InputError};
use parameters::numbers::{CLEARANCE, EDGE_RADIUS, FLANGE, Kind};
use parameters::{Parameter, Path, Transform};

/// Applies a value of a parameter to the finger or to the shapes of the task.
pub(in crate::evaluation) fn change(parameter: &Parameter, value: f64, scenario: &mut Scenario) {
    let Scenario { finger, task, .. } = scenario;
    match parameter.path.kind() {
        Kind::Finger => {
            if let Some((number, unit)) = finger.number(&parameter.path) {
                let own = *number / unit;
                // A neutral value (shift 0 or factor 1) leaves the number bit-identical.
                if parameter.transform == Transform::Value || value != parameter.neutral(own) {
                    *number = parameter.applied(own, value) * unit;
                }
            }
        }
        Kind::Springs => {
            finger.compliance = parameter.applied(finger.compliance, value);
            finger.assembly = parameter.applied(finger.assembly, value);
        }
        Kind::Added => {
            let size = parameter.applied(0.0, value) * MM;
            // A size of 0 leaves the shape unchanged.
            if size != 0.0 {
                *task = if parameter.path == CLEARANCE {
                    Conditions { clearance: size, ..Conditions::NOMINAL }.task(task)
                } else if parameter.path == EDGE_RADIUS {
                    task.rounded(size)
                } else {
                    task.chamfered(size)
                };
            }
        }
        Kind::Infill | Kind::File | Kind::Robot | Kind::Error | Kind::Fixed => (),
    }
}

impl Robot {
    /// Returns the numbers of a path, which are scaled together, and the SI value of the path's unit; no numbers if
    /// the robot lacks them.
    fn numbers(&mut self, path: &Path) -> (Vec<&mut f64>, f64) {
        let numbers = match (&**path, &mut self.drive) {
            ("robot.stop_force_n", _) => vec![&mut self.stop_force],
            (FLANGE, Drive::Servo(servo)) => {
                servo.stiffness.iter_mut().chain(&mut servo.rotational_stiffness).collect()
            }
            ("robot.mass_kg", Drive::Servo(servo)) => vec![&mut servo.mass],
            ("robot.inertia_kg_m2", Drive::Servo(servo)) => vec![&mut servo.inertia],
            ("robot.damping_ratio", Drive::Servo(servo)) => vec![&mut servo.damping_ratio],
            _ => Vec::new(),
        };
        (numbers, if path == FLANGE { N_PER_MM } else { 1.0 })
    }

    /// Returns the number of a path, in its unit, if the robot has it.
    pub fn number(&self, path: &Path) -> Option<f64> {
        let mut robot = self.clone();
        let (numbers, unit) = robot.numbers(path);
        numbers.first().map(|number| **number / unit)
    }

    /// Returns whether the robot has the number of a parameter; true for a parameter of task or finger.
    pub fn fits(&self, parameter: &Parameter) -> bool {
        parameter.path.kind() != Kind::Robot || self.number(&parameter.path).is_some()
    }

    /// Applies a value of a parameter to the robot.
    pub fn change(&mut self, parameter: &Parameter, value: f64) {
        let (numbers, unit) = self.numbers(&parameter.path);
        let Some(own) = numbers.first().map(|number| **number / unit) else { return };
        let ratio = parameter.applied(own, value) / own;
        let factor = if parameter.transform == Transform::Factor { value } else { ratio };
        numbers.into_iter().for_each(|number| *number *= factor);
    }
}

impl Evaluator {
    /// Returns the value of a key in the unit of the key: from the cell, else from the task file or the finger file.
    pub fn number(&self, template: &Template, key: &str) -> Option<f64> {
        let (none, rows) = (Design::default(), self.rows(Some(template)));
        let set = self.completed(Some(template), &none, &rows);
        set.get(key).or_else(|| self.in_file(Some(template), key))
    }

    /// Returns whether task, finger or robot has the number of a parameter.
    pub fn has(&self, template: &Template, parameter: &Parameter) -> bool {
        let is_in_file = || self.number(template, &parameter.path).is_some();
        self.robot.fits(parameter) && (parameter.path.kind() != Kind::File || is_in_file())
    }

    /// Checks that the task of a cell, if the evaluator has it, has the paths of the cell's parameters; `file` is named
    /// in errors.
    ///
    /// # Errors
    /// The first parameter with an unknown path, and the nearest known path.
    pub fn check_paths(&self, cell: &Priors, file: &str) -> Result<(), InputError> {
        let own = |template: &&Template| cell.task.as_ref() == Some(&template.task.name);
        for template in self.templates.iter().filter(own) {
            let in_task =
                |row: &&Parameter| row.path.kind() == Kind::File && row.path.starts_with("task.");
            for row in cell.parameters.iter().filter(in_task) {
                if template.numbers.number(&row.path).is_none() {
                    let paths = template.numbers.keys();
                    let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
                    return Check { file }.fail(&row.name, unknown_path(&row.path, &paths));
                }
            }
        }
        Ok(())
    }

    /// Checks the values of the evaluator's cell on each task; `file` is named in errors.
    ///
    /// # Errors
    /// The first parameter with an invalid value, or the error of [`Evaluator::check_paths`].
    pub fn check_cell(&self, file: &str) -> Result<(), InputError> {
        let Some(cell) = &self.cell else { return Ok(()) };
        self.check_paths(cell, file)?;
        for template in &self.templates {
            for row in cell.of(&template.task.name).filter(|row| row.path.kind() == Kind::File) {
                let value = self.number(template, &row.path).filter(|_| !is_shape(&row.path));
                let Some(value) = value else { continue };
                let design = Design::infill(0.0, 0.0).with(&row.path, value);
                let stiffness = Prediction::exact(1.0, 1.0);
                if let Err(error) = template.apply(&design, &FingerSource::Paper, &stiffness) {
                    return Check { file }.fail(&row.name, error.to_string());
                }
            }
        }
        Ok(())
    }

    /// Returns the number of a key in the task file, if a template is given, or in the finger file.
    fn in_file(&self, template: Option<&Template>, key: &str) -> Option<f64> {
        let in_task = template.and_then(|template| template.numbers.number(key));
        let FingerSource::Computed(fingers) = &self.fingers else { return in_task };
        in_task.or_else(|| fingers.file.numbers.number(key))
    }

    /// Returns the parameters of the cell that apply to a task, by default the first, with their nominal values.
    pub(crate) fn rows(&self, template: Option<&Template>) -> Vec<(&Parameter, f64)> {
        let Some(cell) = &self.cell else { return Vec::new() };
        let task = template.or(self.templates.first()).map_or("", |template| &template.task.name);
        cell.of(task).map(|row| (row, row.middle())).collect()
    }

    /// Returns a design with the values of these parameters of a cell for the numbers that it does not set.
    pub(in crate::evaluation) fn completed(
        &self,
        template: Option<&Template>,
        design: &Design,
        rows: &[(&Parameter, f64)],
    ) -> Design {
        let mut set = design.clone();
        for (row, value) in rows {
            if row.path.kind() == Kind::File
                && design.get(&row.path).is_none()
                && let Some(own) = self.in_file(template, &row.path)
            {
                set.0.insert(row.path.to_string(), row.applied(own, *value));
            }
        }
        set
    }

    /// Returns the scenario of a design with these values of parameters, in addition to those of the cell.
    /// The stiffness is predicted unless given.
    ///
    /// # Errors
    /// If a value is invalid.
    pub fn apply(
        &self,
        template: &Template,
        (design, given): (&Design, Option<Prediction>),
        values: &[(&Parameter, f64)],
    ) -> Result<Scenario, DesignError> {
        let mut set = design.clone();
        for (parameter, value) in values {
            let path = &parameter.path;
            if path.kind() == Kind::File
                && let Some(own) = design.get(path).or_else(|| self.number(template, path))
            {
                set.0.insert(path.to_string(), parameter.applied(own, *value));
            }
        }
        let stiffness = given.map_or_else(|| self.predict(&set), Ok)?;
        let mut scenario = self.scenario(template, &set, stiffness)?;
        for (parameter, value) in values {
            change(parameter, *value, &mut scenario);
            scenario.robot.change(parameter, *value);
        }
        Ok(scenario)
    }

    /// Returns the scenario with these values of another cell's parameters. The parameters of the evaluator's cell
    /// whose paths the other cell lacks still apply.
    pub(in crate::evaluation) fn in_cell(
        &self,
        scenario: &Scenario,
        cell: &Priors,
        values: &[f64],
    ) -> Result<Scenario, DesignError> {
        let Scenario { task, design, stiffness, .. } = scenario;
        let Some(template) = self.templates.iter().find(|own| own.task.name == task.name) else {
            return Ok(DESIGN.fail(&task.name, "unknown task of this evaluator")?);
        };
        let of_task: Vec<&Parameter> = cell.of(&task.name).collect();
        let drawn = cell.parameters.iter().zip(values.iter().copied());
        let drawn = drawn.filter(|(row, _)| of_task.contains(row));
        let mut robot = cell.robot(&cell.name)?.unwrap_or_else(|| self.robot.clone());
        drawn.clone().for_each(|(row, value)| robot.change(row, value));
        let mut rows = self.rows(Some(template));
        rows.retain(|(own, _)| of_task.iter().all(|row| row.path != own.path));
        rows.extend(drawn);
        let drawn = self.scenario_under(template, design, *stiffness, &rows)?;
        Ok(Scenario { robot, ..drawn })
    }
}
