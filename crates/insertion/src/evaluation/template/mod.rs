//! Templates of tasks, for designs that set other parameters besides the infill (co-design).
//!
//! A key of a search space is `infill_density_percent`, `infill_direction_deg`, or a path to one number:
//!
//! - `task.`, then the path in the task file as described at [`NumberFile`]
//!   (`task.strategy.phase.side.speed_mm_per_s`, `task.strategy.phase.side.move_mm.y`);
//! - `finger.`, then a number of the finger model (`finger.rcc_mm`) or of the finger file
//!   (`finger.skin.thickness_mm`).
//!
//! Values are in the unit of the key and are subject to the checks of the task file or finger file.

pub mod printable;
mod space;

pub use space::within_limits;

use crate::finger::file::is_shape;
use crate::trial::run::RigError;
use crate::{DENSITY_KEY, DIRECTION_KEY, Design, Finger, FingerSource, Prediction, Task};
use input::numbers::{DESIGN, NumberFile};
use input::{Document, InputError, Place, Placed};
use parameters::Path;
use parameters::numbers::{self, Kind, paths};

/// Task file whose numbers a design may set.
#[derive(Debug, Clone)]
pub struct Template {
    /// Numbers of the file, by their keys.
    pub numbers: NumberFile,
    /// Task of the file, unchanged.
    pub task: Task,
}

/// Error of a design that cannot be simulated.
#[derive(Debug, thiserror::Error)]
pub enum DesignError {
    /// An unknown path, a value out of range, or a finger that cannot be printed or modelled.
    #[error(transparent)]
    Value(#[from] InputError),
    /// A task that the robot or the engine does not support.
    #[error(transparent)]
    Rig(#[from] RigError),
}

impl Placed for DesignError {
    fn place(&self) -> Place {
        if let DesignError::Value(error) = self { error.place() } else { Place::default() }
    }
}

/// Returns whether a key sets the infill.
pub(super) fn is_infill(key: &str) -> bool {
    [DENSITY_KEY, DIRECTION_KEY].contains(&key)
}

impl Template {
    /// Reads and checks a task file; `file` is named in errors.
    ///
    /// # Errors
    /// Same as for [`Task::parse`].
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let document = Document::parse(text, file)?;
        let task = Task::read(&document)?;
        Ok(Template { numbers: NumberFile::read("task", &document)?, task })
    }

    /// Returns the task with the values of a design, and its finger with the stiffness `at_pad`, which acts at the pad
    /// or, in the paper's finger model, at the remote centre.
    ///
    /// # Errors
    /// If a key does not exist, a value is invalid, or the finger cannot be built.
    pub fn apply(
        &self,
        design: &Design,
        fingers: &FingerSource,
        at_pad: &Prediction,
    ) -> Result<(Task, Finger), DesignError> {
        let values = design.0.iter().map(|(key, &value)| (key.as_str(), value));
        let (of_finger, of_task): (Vec<_>, Vec<_>) = values
            .filter(|(key, _)| !is_infill(key) && !is_shape(key))
            .partition(|(key, _)| Path::new(*key).is_ok_and(|path| path.kind() == Kind::Finger));
        let shape = design.0.keys().find(|key| is_shape(key));
        if let (FingerSource::Paper, Some(key)) = (fingers, shape) {
            let problem = "is a number of a printed finger; it requires --finger-model computed";
            return Ok(DESIGN.fail(key, problem)?);
        }
        let task = self.task_with(&of_task)?;
        let direction = design.get(DIRECTION_KEY);
        if task.finger.rcc.is_some_and(|rcc| rcc.varies()) && direction.is_none() {
            let problem = "is missing: the task's finger.rcc_mm depends on it";
            return Ok(DESIGN.fail(DIRECTION_KEY, problem)?);
        }
        for (key, value) in &of_finger {
            numbers::check(DESIGN, key, *value)?;
        }
        let mut finger = fingers.make(at_pad, design, &task)?;
        for (key, value) in of_finger {
            if let Some((number, unit)) = finger.number(key) {
                *number = value * unit;
            }
        }
        Ok((task, finger))
    }

    /// Returns the task with the given values.
    fn task_with(&self, of_task: &[(&str, f64)]) -> Result<Task, InputError> {
        if of_task.is_empty() {
            return Ok(self.task.clone());
        }
        let finger = paths(Kind::Finger);
        let finger = finger.iter().map(String::as_str);
        let elsewhere: Vec<_> = finger.chain([DENSITY_KEY, DIRECTION_KEY]).collect();
        let table = self.numbers.with(of_task.iter().copied(), &elsewhere)?;
        let changed = Task::from_table(table, &self.numbers.file);
        changed.or_else(|error| {
            // The file itself is valid, so a value of the design causes the error.
            let is_cause = |path: &&str| path.strip_prefix("task.") == error.place.key.as_deref();
            let cause = of_task.iter().map(|(path, _)| *path).find(is_cause);
            let Some(path) = cause else { return Err(error) };
            DESIGN.fail(path, error.problem)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finger::Finger;
    use crate::task::{Ending, TouchDetection};
    use crate::tests::fixtures::{refused, task_file, template};
    use input::shipped::TASKS;
    use input::units::{DEG, MM};
    use std::collections::BTreeMap;

    fn at_pad() -> Prediction {
        Prediction::exact(2e3, 4e4)
    }

    fn finger() -> Finger {
        Finger::new(2e3, 4e4)
    }

    fn apply(values: &[(&str, f64)]) -> Result<(Task, Finger), DesignError> {
        let values = values.iter().map(|&(key, value)| (key.to_owned(), value));
        let design = Design(BTreeMap::from_iter(values));
        template("usb").apply(&design, &FingerSource::Paper, &at_pad())
    }

    #[test]
    fn each_value_arrives_in_si_units_and_nothing_else_changes() {
        let (task, changed) = apply(&[
            ("task.strategy.tilt_deg", 8.0),
            ("task.strategy.phase.touch.preload_mm", 0.5),
            ("task.strategy.phase.side.move_mm.y", -9.0),
            ("task.grip.force_n", 7.0),
            ("task.plug.part.metal shell.x_mm.0", -2.0),
            ("finger.rcc_mm", 15.0),
            ("finger.rotation_x_nm_per_rad", 1.5),
        ])
        .unwrap();
        let mut expected = template("usb").task.clone();
        expected.strategy.tilt = 8.0 * DEG;
        expected.strategy.phases[1].ending =
            Ending::Touch { preload: 0.5 * MM, detection: TouchDetection::FIRST };
        expected.strategy.phases[4].displacement[1] = -9.0 * MM;
        expected.grip.force = 7.0;
        let crate::task::Solid::Box { min, .. } = &mut expected.plug.parts[0].solid else {
            panic!("the shell is a box")
        };
        min.x = -2.0 * MM;
        assert_eq!(task, expected);
        let [_, ry, rz] = finger().rotation;
        assert_eq!(changed, Finger { rcc: 15.0 * MM, rotation: [1.5, ry, rz], ..finger() });
    }

    #[test]
    fn every_key_that_is_listed_can_be_set_to_what_it_is() {
        for file in TASKS {
            let template = template(file.name);
            let keys = template.numbers.keys().into_iter();
            let values = keys.map(|key| (key.clone(), template.numbers.number(&key).unwrap()));
            let design = Design(values.collect());
            assert!(design.0.len() > 50, "{}", file.name);
            let (task, _) = template.apply(&design, &FingerSource::Paper, &at_pad()).unwrap();
            assert_eq!(&task, &template.task);
        }
    }

    #[test]
    fn impossible_values_and_unknown_keys_are_named() {
        for (key, value, words) in [
            ("task.strategy.tilt_deg", 60.0, "strategy.tilt_deg: is 60; it must lie in -45 .. 45"),
            ("task.strategy.tilt_deg", 400.0, "design: task.strategy.tilt_deg: is 400; "),
            ("task.grip.force_n", f64::NAN, "grip.force_n: is NaN"),
            ("task.strategy.phase.side.move_mm.y", 0.0, "\"side\" move_mm: is zero"),
            ("finger.mass_g", 0.0, "finger.mass_g: is 0; it must lie in"),
            ("finger.rcc_mm", f64::INFINITY, "finger.rcc_mm: is inf"),
            ("finger.rcc", 1.0, "`finger.` continues with damping_n_s_per_m, depth_n_per_mm"),
            ("task.strategy.start_mm", 1.0, "`task.strategy.start_mm.` continues with x, y, z"),
            ("tilt", 1.0, "begins with `finger`, `infill_density_percent`, `infill_direction_"),
            ("task.friction.plug_sokcet", 0.2, "did you mean `task.friction.plug_socket`?"),
        ] {
            refused(apply(&[(key, value)]), &[words]);
        }
    }

    #[test]
    fn two_tables_of_one_name_are_told_apart_before_one_is_set() {
        let text = task_file("usb").text.replace("name = \"front\"", "name = \"back\"");
        let template = Template::parse(&text, "my.toml").unwrap();
        let design = Design([("task.strategy.phase.back.settle_s".to_owned(), 0.1)].into());
        refused(template.apply(&design, &FingerSource::Paper, &at_pad()), &["same name"]);
    }
}
