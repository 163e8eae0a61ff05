//! Parameters of a robot cell that a task file does not set: priors (`priors/bench.toml`), or values identified from
//! robot logs (`cell.toml`) with the robot of the identification.

mod applied;

pub(super) use applied::change;

use crate::Robot;
use input::{Check, InputError, read};
use parameters::Parameter;
use serde::{Deserialize, Serialize};

/// Priors or identified values of a cell, as read and written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Priors {
    /// Name of the priors or of the cell.
    pub name: String,
    /// Description in one line.
    pub description: String,
    /// Task to which the parameters with `shared = false` apply; `None` if they apply to every task.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub task: Option<String>,
    /// Contents of the cell's robot file, if the file contains one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<toml::Table>,
    /// Priors or identified values of the parameters.
    #[serde(rename = "parameter")]
    pub parameters: Vec<Parameter>,
}

impl Priors {
    /// Reads and checks a file; `file` is named in errors.
    ///
    /// # Errors
    /// If the text cannot be parsed; see also [`Priors::checked`].
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        read::<Priors>(text, file)?.checked(file)
    }

    /// Checks every parameter and the robot; `file` is named in errors.
    ///
    /// # Errors
    /// If a parameter or the robot is invalid; the error names the first invalid one and states what is accepted.
    pub fn checked(self, file: &str) -> Result<Self, InputError> {
        let (all, check) = (&self.parameters, Check { file });
        for (i, parameter) in all.iter().enumerate() {
            let name = &parameter.name;
            parameter.check(check)?;
            if all[..i].iter().any(|other| other.name == *name || other.path == parameter.path) {
                return check.fail(name, "is given twice; give each name and each path once");
            }
        }
        if let Some(robot) = self.robot(file)? {
            for row in all {
                if !row.shared && !row.path.starts_with("task.") {
                    return check.fail(&row.name, "does not belong to a task; give shared = true");
                }
                if !robot.fits(row) {
                    return check.fail(&row.name, "goes with a robot of kind = \"servo\"");
                }
            }
        }
        Ok(self)
    }

    /// Returns the robot of the cell, if the file contains one; `file` is named in errors.
    ///
    /// # Errors
    /// If the table is not a robot file.
    pub fn robot(&self, file: &str) -> Result<Option<Robot>, InputError> {
        let robot = |text: String| Robot::parse(&text, &format!("{file}: [robot]"));
        self.robot_text().map(robot).transpose()
    }

    /// Returns the text of the cell's robot file, if the file contains one.
    pub fn robot_text(&self) -> Option<String> {
        self.robot.as_ref().map(toml::Table::to_string)
    }

    /// Returns the parameters that apply to a task.
    pub fn of(&self, task: &str) -> impl Iterator<Item = &Parameter> {
        let own = self.task.as_ref().is_none_or(|own| own == task);
        self.parameters.iter().filter(move |row| row.shared || own)
    }

    /// Returns the paths of the parameters that were identified on another task and do not apply to this one.
    pub fn not_applied(&self, task: &str) -> Vec<&str> {
        let own = self.task.as_ref().is_none_or(|own| own == task);
        let others = self.parameters.iter().filter(|row| !row.shared && !own);
        others.map(|row| &*row.path).collect()
    }

    /// Returns a sentence that names the parameters that do not apply to a task; `None` if all do.
    pub fn remark(&self, task: &str) -> Option<String> {
        let names = self.not_applied(task);
        let own = self.task.as_ref().filter(|_| !names.is_empty())?;
        let (name, names) = (&self.name, names.join(", "));
        Some(format!("cell `{name}` was identified on {own}; not applied to {task}: {names}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::{refused, robot, robot_file};
    use input::shipped::{LEVERS, PRIORS};

    #[test]
    fn every_shipped_row_has_bounds_and_a_source() {
        for file in PRIORS.iter().chain(LEVERS) {
            let rows = Priors::parse(file.text, file.file).unwrap().parameters;
            assert!(rows.len() >= 7);
            for row in &rows {
                assert!((row.at(0.0) - row.low).abs() < 1e-12, "{}", row.name);
                assert!((row.at(1.0) / row.high - 1.0).abs() < 1e-12, "{}", row.name);
            }
        }
        let friction = &Priors::parse(PRIORS[0].text, PRIORS[0].file).unwrap().parameters[0];
        assert!((friction.applied(0.2, friction.at(0.5)) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn a_cell_is_read_as_it_is_written() {
        let servo = robot_file("servo");
        let mut cell = Priors::parse(PRIORS[0].text, PRIORS[0].file).unwrap();
        cell.task = Some("usb".to_owned());
        cell.robot = Some(servo.text.parse().unwrap());
        (cell.parameters[0].value, cell.parameters[0].sd) = (Some(0.9), Some(0.1));
        let text = toml::to_string(&cell).unwrap();
        assert_eq!(Priors::parse(&text, "cell.toml").unwrap(), cell);
        assert_eq!(cell.robot("cell.toml").unwrap(), Some(robot("servo")));
        assert_eq!(cell.of("usb").count(), cell.parameters.len());
        assert!(cell.of("ket8").all(|row| row.shared));
        cell.robot = Some(servo.text.replace("servo\"", "rigid\"").parse().unwrap());
        refused(cell.checked("c"), &["[robot]"]);
    }

    #[test]
    fn each_bad_row_is_named() {
        let good = PRIORS[0].text;
        for (from, to, word) in [
            ("low = 0.5", "low = 5.0", "below high"),
            ("low = 0.5", "low = -0.5", "above 0"),
            (
                "edge_radius_mm\"\nas = \"shift",
                "edge_radius_mm\"\nas = \"factor",
                "its nominal value is 0",
            ),
            ("\"task.friction.plug_socket\"", "\"friction\"", "unknown path `friction`"),
            ("plug_socket\"", "plug_sokcet\"", "mean `task.friction.plug_socket`?"),
            ("task.friction.plug_socket\"", "cell.clearance_mm\"", "cannot be set by a cell"),
            ("name = \"friction pad-plug\"", "name = \"friction plug-socket\"", "twice"),
            ("\nscale = \"log\"", "\nscale = \"logg\"", "logg"),
            ("\nlow = 0.5", "\nlow = 0.5\nvalue = 1.0", "go together"),
            ("\nlow = 0.5", "\nlow = 0.5\nvalue = 9.0\nsd = 1.0", "must lie in 0.5 .. 2"),
            ("\nlow = 0.5", "\nlow = 0.5\nvalue = 1.0\nsd = -1.0", "0 or above"),
            ("\nlow = 0.5", "\nlow = 0.5\nvalue = nan\nsd = 1.0", "NaN"),
            ("[[parameter]]", "[robot]\nname = \"r\"\n[[parameter]]", "[robot]"),
        ] {
            refused(Priors::parse(&good.replacen(from, to, 1), "p.toml"), &[word, "p.toml"]);
        }
    }
}
