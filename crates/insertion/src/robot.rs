//! The robot as the flange feels it: ideal, soft about its servos, or an arm.

use crate::arm::arm;
use crate::arm::{Arm, ArmError, RawArm, Reduced};
use input::units::N_PER_MM;
use input::{Check, Document, InputError};
use nalgebra::Vector3;
use serde::Deserialize;

/// A checked robot, SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Name on the command line.
    pub name: String,
    /// One-line description for lists.
    pub description: String,
    /// Suspension of the flange.
    pub drive: Drive,
    /// Plug-socket contact force at which the robot stops moving, N.
    pub stop_force: f64,
}

/// Suspension of a robot's flange.
#[derive(Debug, Clone, PartialEq)]
pub enum Suspension<A> {
    /// Rigid: the flange follows its command exactly.
    Ideal,
    /// A spring and damper per Cartesian axis at the TCP.
    Servo(Servo),
    /// Six joints with servos.
    Arm(Box<A>),
}

/// Suspension of a flange, wherever the robot stands.
pub type Drive = Suspension<Arm>;

/// Suspension in place: of an arm its coupled spring, damper and mass at the TCP.
pub type Flange = Suspension<Reduced>;

/// A servo-compliant flange, SI units, axes of the task frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servo {
    /// N/m along x, y and z.
    pub stiffness: [f64; 3],
    /// N m/rad about x, y and z.
    pub rotational_stiffness: [f64; 3],
    /// Mass felt at the TCP, kg.
    pub mass: f64,
    /// Moment of inertia felt about each axis, kg m2.
    pub inertia: f64,
    /// Damping ratio; 1 is critical.
    pub damping_ratio: f64,
}

/// A robot in place for a task: what its flange feels like there.
#[derive(Debug, Clone, PartialEq)]
pub struct Mounted {
    /// Response of the flange to its command.
    pub flange: Flange,
    stop_force: f64,
}

impl Robot {
    /// The robot at the start of a task whose frame is turned by `turn` about the
    /// base's z, with the TCP tilted by `tilt` about the task's x, rad.
    ///
    /// # Errors
    /// If an arm does not reach the start, or is singular there.
    pub fn mount(&self, turn: f64, tilt: f64) -> Result<Mounted, ArmError> {
        let flange = match &self.drive {
            Drive::Ideal => Flange::Ideal,
            Drive::Servo(servo) => Flange::Servo(*servo),
            Drive::Arm(arm) => Flange::Arm(Box::new(arm.at_start(turn, tilt)?)),
        };
        Ok(Mounted { flange, stop_force: self.stop_force })
    }
}

/// Time constants after which a servo has all but reached its command.
const SETTLED: f64 = 5.0;

impl Mounted {
    /// How much farther an assembly move along a unit vector is commanded, m: by what
    /// the arm gives under its assembly force. A soft arm that is sent to where the
    /// part should be hardly pushes it there.
    pub fn lead(&self, along: &Vector3<f64>) -> f64 {
        let lead = |arm: &Reduced| arm.assembly_force * along.dot(&(arm.compliance * along));
        self.arm().map_or(0.0, lead)
    }

    /// Time that the robot takes to follow a command, s.
    pub fn settling(&self) -> f64 {
        self.arm().map_or(0.0, |arm| SETTLED * arm.time_constant)
    }

    /// Whether this plug-socket force, N, task axes, stops the robot or overloads a joint.
    pub fn stops(&self, force: &Vector3<f64>) -> bool {
        self.arm().is_some_and(|arm| arm.overloaded(force)) || force.norm() > self.stop_force
    }

    fn arm(&self) -> Option<&Reduced> {
        match &self.flange {
            Flange::Arm(arm) => Some(arm),
            Flange::Ideal | Flange::Servo(_) => None,
        }
    }
}

/// Drives of a robot file.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Kind {
    Rigid,
    Servo,
    Arm,
}

/// The one key that says which others there are. Not a tagged enum, the errors of which have no line.
#[derive(Deserialize)]
struct Tagged {
    kind: Kind,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRigid {
    #[serde(rename = "kind")]
    _kind: Kind,
    name: String,
    description: String,
    stop_force_n: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawServo {
    #[serde(rename = "kind")]
    _kind: Kind,
    name: String,
    description: String,
    stop_force_n: f64,
    stiffness_n_per_mm: [f64; 3],
    rotational_stiffness_nm_per_rad: [f64; 3],
    mass_kg: f64,
    inertia_kg_m2: f64,
    damping_ratio: f64,
}

impl RawServo {
    fn checked(&self, check: Check<'_>) -> Result<Servo, InputError> {
        let positive = |key: &str, value: f64| check.positive(key, value);
        let positives = |key: &str, values| check.each(key, values, Check::positive);
        let rotational = "rotational_stiffness_nm_per_rad";
        Ok(Servo {
            stiffness: positives("stiffness_n_per_mm", self.stiffness_n_per_mm)?
                .map(|k| k * N_PER_MM),
            rotational_stiffness: positives(rotational, self.rotational_stiffness_nm_per_rad)?,
            mass: positive("mass_kg", self.mass_kg)?,
            inertia: positive("inertia_kg_m2", self.inertia_kg_m2)?,
            damping_ratio: positive("damping_ratio", self.damping_ratio)?,
        })
    }
}

impl Robot {
    /// Reads and checks a robot; `file` is named in errors.
    ///
    /// # Errors
    /// If the text is not such a file, or a value cannot be used.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let (document, check) = (Document::parse(text, file)?, Check { file });
        let (name, description, stop_force_n, drive) = match document.read::<Tagged>()?.kind {
            Kind::Rigid => {
                let raw: RawRigid = document.read()?;
                (raw.name, raw.description, raw.stop_force_n, Drive::Ideal)
            }
            Kind::Servo => {
                let raw: RawServo = document.read()?;
                let servo = Drive::Servo(raw.checked(check)?);
                (raw.name, raw.description, raw.stop_force_n, servo)
            }
            Kind::Arm => {
                let raw: RawArm = document.read()?;
                let arm = Drive::Arm(Box::new(arm(check, &raw)?));
                (raw.name, raw.description, raw.stop_force_n, arm)
            }
        };
        let stop_force = check.positive("stop_force_n", stop_force_n)?;
        Ok(Robot { name, description, drive, stop_force })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::ROBOTS;
    use input::{Place, Placed};

    #[test]
    fn a_value_of_a_wrong_type_is_told_with_its_line() {
        for robot in ROBOTS {
            Robot::parse(robot.text, robot.file).unwrap();
            for (at, line) in robot.text.lines().enumerate() {
                let Some((key, _)) = line.split_once(" = ") else { continue };
                if key.starts_with('#') || line.ends_with("true") || line.ends_with("false") {
                    continue;
                }
                for wrong in ["[1.0, 2.0]", "true"] {
                    let mut lines: Vec<&str> = robot.text.lines().collect();
                    let new = format!("{key} = {wrong}");
                    lines[at] = &new;
                    let error = Robot::parse(&lines.join("\n"), "r.toml").unwrap_err();
                    let Place { file, line, .. } = error.place();
                    assert_eq!((file.as_deref(), line), (Some("r.toml"), Some(at + 1)), "{error}");
                    assert!(error.to_string().contains(&new), "{error}");
                }
            }
        }
    }
}
