//! Checks, before a study starts, that every design of a space can be simulated.

use super::{DesignError, Template, is_infill};
use crate::finger::file::is_shape;
use crate::space::{corners, is_of_task};
use crate::trial::run::RigError;
use crate::{DENSITY_KEY, DIRECTION_KEY, Design, FingerSource, Prediction, Space, Task, Variable};
use input::units::MM;
use input::{Check, InputError, Place};

/// Returns a space whose speeds do not exceed the limits of the connectors (`limits.speed_mm_per_s`).
pub fn within_limits(mut space: Space, templates: &[Template]) -> Space {
    let limits = templates.iter().filter_map(|template| template.task.limits.speed);
    let limit = limits.fold(f64::INFINITY, f64::min) / MM;
    let speeds = |variable: &&mut Variable| {
        is_of_task(&variable.key) && variable.key.ends_with(".speed_mm_per_s")
    };
    for variable in space.parameters.iter_mut().filter(speeds) {
        if variable.low <= limit && limit < variable.high {
            let levels = (0..variable.levels()).map(|level| variable.value(level));
            variable.high =
                levels.take_while(|&speed| speed <= limit).last().unwrap_or(variable.low);
        }
    }
    space
}

/// Checks the extreme values of variables one at a time with `check_design`.
///
/// # Errors
/// The first value that fails.
pub(super) fn each_extreme<'a>(
    check: Check<'_>,
    variables: impl Iterator<Item = &'a Variable>,
    check_design: impl Fn(&Design) -> Result<(), DesignError>,
) -> Result<(), InputError> {
    for variable in variables {
        for value in variable.extremes() {
            let problem = match check_design(&Design::default().with(&variable.key, value)) {
                Ok(()) => continue,
                Err(DesignError::Value(InputError {
                    place: Place { key: Some(key), .. },
                    problem,
                })) if variable.key == key => problem,
                Err(error) => format!("cannot be {value}: {error}"),
            };
            return check.fail(&variable.key, problem);
        }
    }
    Ok(())
}

/// Checks the combinations of extreme values ([`corners`]) with `check_design`.
///
/// # Errors
/// The first combination that fails, as an error of `key`; `words` state the failure.
pub(super) fn each_corner<'a>(
    check: Check<'_>,
    key: &str,
    (variables, most): (impl Iterator<Item = &'a Variable>, usize),
    words: &str,
    check_design: impl Fn(&Design) -> Result<(), DesignError>,
) -> Result<(), InputError> {
    for design in corners(variables, most) {
        if let Err(error) = check_design(&design) {
            return check.fail(key, format!("{design} {words}: {error}"));
        }
    }
    Ok(())
}

/// Check whether robot and engine support a task.
pub type TaskCheck<'a> = dyn Fn(&Task) -> Result<(), RigError> + 'a;

/// Largest number of combinations of extreme values to check.
const MAX_CORNERS: usize = 4096;

impl Template {
    /// Checks a space read from `file`: it must contain the infill, all other keys must exist, and all combinations of
    /// extreme values must be valid; `fits` checks robot and engine.
    ///
    /// The checks of a task bound single numbers and differences of two numbers, so if the corners of a space are
    /// valid, all its designs are. Since moves must not be zero, the level nearest to zero counts as extreme. With more
    /// than 4096 combinations, values are only checked one at a time.
    ///
    /// # Errors
    /// The first invalid key or combination.
    pub fn check(&self, space: &Space, file: &str, fits: &TaskCheck<'_>) -> Result<(), InputError> {
        let check = Check { file };
        let has = |key: &&str| space.parameters.iter().any(|parameter| parameter.key == *key);
        if let Some(missing) = [DENSITY_KEY, DIRECTION_KEY].into_iter().find(|key| !has(key)) {
            let problem = "is missing: a space must contain it; to fix it, set low equal to high";
            return check.fail(missing, problem);
        }
        let other = |p: &&Variable| !is_infill(&p.key) && !is_shape(&p.key);
        let parameters = || space.parameters.iter().filter(other);
        let check_design = |design: &Design| self.check_design(design, fits);
        each_extreme(check, parameters(), check_design)?;
        each_corner(check, "parameter", (parameters(), MAX_CORNERS), "is impossible", check_design)
    }

    /// Checks that a design can be simulated.
    fn check_design(&self, design: &Design, fits: &TaskCheck<'_>) -> Result<(), DesignError> {
        // The stiffness is arbitrary: the checks do not depend on it.
        let mut design = design.clone();
        design.0.entry(DIRECTION_KEY.to_owned()).or_insert(0.0);
        let (task, _) = self.apply(&design, &FingerSource::Paper, &Prediction::exact(1.0, 1.0))?;
        Ok(fits(&task)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::{robot, template};
    use crate::trial::run::EngineRig;
    use contact::direct::Direct;
    use input::shipped::{ROBOTS, SPACES, TASKS};

    fn check(parameters: &[(&str, f64, f64)]) -> Result<(), InputError> {
        let infill = [(DENSITY_KEY, 10.0, 30.0), (DIRECTION_KEY, 0.0, 40.0)];
        let parameter = |(key, low, high): &(&str, f64, f64)| {
            format!(
                "[[parameter]]\nkey = '{key}'\nlow = {low:?}\nhigh = {high:?}\nstep = 1.0\nsource = ''\n"
            )
        };
        let text: String = infill.iter().chain(parameters).map(parameter).collect();
        let text = format!("name = 's'\ndescription = ''\n{text}");
        template("usb").check(&Space::parse(&text, "s.toml").unwrap(), "s.toml", &|_| Ok(()))
    }

    #[test]
    fn every_shipped_space_fits_every_shipped_task_and_robot() {
        for space in SPACES {
            let space = Space::parse(space.text, space.file).unwrap();
            for task in TASKS {
                let template = template(task.name);
                for file in ROBOTS {
                    let robot = robot(file.name);
                    let fits = |task: &Task| {
                        let engine = Box::new(Direct::default());
                        EngineRig::new(task.clone(), &robot, engine).map(|_| ())
                    };
                    template.check(&space, "s.toml", &fits).unwrap();
                }
            }
        }
    }

    #[test]
    fn an_impossible_bound_or_combination_is_told_before_anything_is_simulated() {
        assert_eq!(check(&[("task.strategy.tilt_deg", 0.0, 45.0)]), Ok(()));
        let side = "task.strategy.phase.side.move_mm";
        let (x, y) = (format!("{side}.x"), format!("{side}.y"));
        assert_eq!(check(&[(&x, -5.0, 5.0)]), Ok(()), "y keeps the move from being zero");
        for (parameters, words) in [
            (vec![("task.grip.tcp_z_mm", 30.0, 60.0)], "s.toml: task.grip.tcp_z_mm: cannot be 60"),
            (vec![(&y, -5.0, 5.0)], "move_mm.y: cannot be 0"),
            (vec![(&x, -5.0, 5.0), (&y, -5.0, -1.0)], ""),
            (
                vec![("task.grip.tcp_z_mm", 40.0, 43.0), ("task.grip.shoulder_z_mm", 42.0, 44.0)],
                "is impossible",
            ),
        ] {
            let error = check(&parameters).err().map_or(String::new(), |error| error.to_string());
            assert!(error.contains(words) && error.is_empty() == words.is_empty(), "{error}");
        }
    }
}
