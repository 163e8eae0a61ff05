//! Values of a cell's numbers on their way into task, finger and robot.

use super::{Parameter, Priors, Target, Way};
use crate::evaluation::evaluator::{Evaluator, Specimen};
use crate::evaluation::template::{Impossible, Template};
use crate::finger::Finger;
use crate::finger::model::FingerSource;
use crate::robot::{Drive, Robot};
use crate::space::Design;
use crate::surrogate::Prediction;
use crate::trial::Conditions;
use input::numbers::DESIGN;
use input::units::{MM, N_PER_MM};

impl Parameter {
    /// Whether a robot has what it sets.
    pub fn fits(&self, robot: &Robot) -> bool {
        self.sets != Target::Flange || matches!(robot.drive, Drive::Servo(_))
    }

    /// Changes what it sets beside the numbers of task and finger file.
    pub(in crate::evaluation) fn change(&self, value: f64, specimen: &mut Specimen) {
        // What leaves a number as it is leaves its last bit, and a sharp edge a box.
        let idle = if self.way == Way::Factor { 1.0 } else { 0.0 };
        if value == idle && (self.way, &self.sets) != (Way::Value, &Target::Centre) {
            return;
        }
        let Finger { compliance, assembly, rotation, rcc, .. } = &mut specimen.finger;
        match self.sets {
            Target::Number(_) | Target::Flange => (),
            Target::Clearance => {
                let clearance = self.applied(0.0, value) * MM;
                specimen.task =
                    Conditions { clearance, ..Conditions::NOMINAL }.task(&specimen.task);
            }
            Target::Edges => specimen.task = specimen.task.rounded(self.applied(0.0, value) * MM),
            Target::Chamfer => {
                specimen.task = specimen.task.chamfered(self.applied(0.0, value) * MM);
            }
            Target::Stiffness => {
                *compliance = self.applied(*compliance, value);
                *assembly = self.applied(*assembly, value);
            }
            Target::Tilting => rotation[0] = self.applied(rotation[0], value),
            Target::Centre => *rcc = self.applied(*rcc / MM, value) * MM,
        }
    }

    /// Changes what it sets of a robot.
    pub fn change_robot(&self, value: f64, robot: &mut Robot) {
        if let (Target::Flange, Drive::Servo(servo)) = (&self.sets, &mut robot.drive) {
            let own = servo.stiffness[0] / N_PER_MM;
            let factor =
                if self.way == Way::Factor { value } else { self.applied(own, value) / own };
            let all = servo.stiffness.iter_mut().chain(&mut servo.rotational_stiffness);
            all.for_each(|stiffness| *stiffness *= factor);
        }
    }
}

impl Evaluator {
    /// The number of that key as the cell has it, else as in the task file, or in the finger file of
    /// computed fingers; in the unit of the key.
    pub fn number(&self, template: &Template, key: &str) -> Option<f64> {
        let (none, rows) = (Design::default(), self.rows(Some(template)));
        let set = self.completed(Some(template), &none, &rows);
        set.get(key).or_else(|| self.in_file(Some(template), key))
    }

    /// Without a template that of a finger file alone.
    fn in_file(&self, template: Option<&Template>, key: &str) -> Option<f64> {
        template.and_then(|template| template.numbers.number(key)).or_else(|| match &self.fingers {
            FingerSource::Paper => None,
            FingerSource::Computed(fingers) => fingers.file.numbers.number(key),
        })
    }

    /// The rows of its cell that apply to a task, or all, with their values.
    pub(in crate::evaluation) fn rows<'a>(
        &'a self,
        of: Option<&'a Template>,
    ) -> Vec<(&'a Parameter, f64)> {
        let Some(cell) = &self.cell else { return Vec::new() };
        let task = of.or(self.templates.first()).map_or("", |template| &template.task.name);
        cell.of(task).map(|row| (row, row.middle())).collect()
    }

    /// A design, and the numbers that these rows set and it does not.
    pub(in crate::evaluation) fn completed(
        &self,
        template: Option<&Template>,
        design: &Design,
        rows: &[(&Parameter, f64)],
    ) -> Design {
        let mut set = design.clone();
        for (row, value) in rows {
            if let Target::Number(key) = &row.sets
                && design.get(key).is_none()
                && let Some(own) = self.in_file(template, key)
            {
                set.0.insert(key.clone(), row.applied(own, *value));
            }
        }
        set
    }

    /// A design under these values of parameters, on top of the cell's, and the robot; its stiffness is
    /// predicted unless given.
    ///
    /// # Errors
    /// If a value sets something to what cannot be.
    pub fn under(
        &self,
        template: &Template,
        (design, given): (&Design, Option<Prediction>),
        values: &[(&Parameter, f64)],
    ) -> Result<(Specimen, Robot), Impossible> {
        let mut set = design.clone();
        for (parameter, value) in values {
            if let Target::Number(key) = &parameter.sets
                && let Some(own) = design.get(key).or_else(|| self.number(template, key))
            {
                set.0.insert(key.clone(), parameter.applied(own, *value));
            }
        }
        let stiffness = given.map_or_else(|| self.predict(&set), Ok)?;
        let mut specimen = self.specimen(template, &set, stiffness)?;
        let mut robot = self.robot.clone();
        for (parameter, value) in values {
            parameter.change(*value, &mut specimen);
            parameter.change_robot(*value, &mut robot);
        }
        Ok((specimen, robot))
    }

    /// A specimen in another cell, whose rows have these values, and its robot; rows of its own cell
    /// that the other lacks stay.
    pub(in crate::evaluation) fn drawn(
        &self,
        specimen: &Specimen,
        cell: &Priors,
        values: &[f64],
    ) -> Result<(Specimen, Robot), Impossible> {
        let Specimen { task, design, stiffness, .. } = specimen;
        let Some(template) = self.templates.iter().find(|of| of.task.name == task.name) else {
            return Ok(DESIGN.fail(&task.name, "is no task of this evaluator")?);
        };
        let of_task: Vec<&Parameter> = cell.of(&task.name).collect();
        let drawn = cell.parameters.iter().zip(values.iter().copied());
        let drawn = drawn.filter(|(row, _)| of_task.contains(row));
        let mut robot = cell.robot(&cell.name)?.unwrap_or_else(|| self.robot.clone());
        drawn.clone().for_each(|(row, value)| row.change_robot(value, &mut robot));
        let mut rows = self.rows(Some(template));
        rows.retain(|(own, _)| of_task.iter().all(|row| row.sets != own.sets));
        rows.extend(drawn);
        Ok((self.specimen_under(template, design, *stiffness, &rows)?, robot))
    }
}
