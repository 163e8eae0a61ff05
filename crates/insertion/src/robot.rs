//! The robot as the flange feels it: ideal, soft about its servos, or an arm.

use crate::arm::arm;
use crate::arm::{Arm, ArmError, RawArm, Reduced};
use input::units::N_PER_MM;
use input::{Check, InputError, read};
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

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
enum RawRobot {
    Rigid {
        name: String,
        description: String,
        stop_force_n: f64,
    },
    Servo {
        name: String,
        description: String,
        stop_force_n: f64,
        stiffness_n_per_mm: [f64; 3],
        rotational_stiffness_nm_per_rad: [f64; 3],
        mass_kg: f64,
        inertia_kg_m2: f64,
        damping_ratio: f64,
    },
    Arm(Box<RawArm>),
}

impl Robot {
    /// Reads and checks a robot; `file` is named in errors.
    ///
    /// # Errors
    /// If the text is not such a file, or a value cannot be used.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let raw: RawRobot = read(text, file)?;
        let check = Check { file };
        let positive = |key: &str, value: f64| check.positive(key, value);
        let (name, description, stop_force_n, drive) = match raw {
            RawRobot::Rigid { name, description, stop_force_n } => {
                (name, description, stop_force_n, Drive::Ideal)
            }
            RawRobot::Servo {
                name,
                description,
                stop_force_n,
                stiffness_n_per_mm,
                rotational_stiffness_nm_per_rad,
                mass_kg,
                inertia_kg_m2,
                damping_ratio,
            } => {
                let positives = |key: &str, values| check.each(key, values, Check::positive);
                let stiffness = positives("stiffness_n_per_mm", stiffness_n_per_mm)?;
                let servo = Servo {
                    stiffness: stiffness.map(|k| k * N_PER_MM),
                    rotational_stiffness: positives(
                        "rotational_stiffness_nm_per_rad",
                        rotational_stiffness_nm_per_rad,
                    )?,
                    mass: positive("mass_kg", mass_kg)?,
                    inertia: positive("inertia_kg_m2", inertia_kg_m2)?,
                    damping_ratio: positive("damping_ratio", damping_ratio)?,
                };
                (name, description, stop_force_n, Drive::Servo(servo))
            }
            RawRobot::Arm(raw) => {
                let arm = Drive::Arm(Box::new(arm(check, &raw)?));
                (raw.name, raw.description, raw.stop_force_n, arm)
            }
        };
        let stop_force = positive("stop_force_n", stop_force_n)?;
        Ok(Robot { name, description, drive, stop_force })
    }
}
