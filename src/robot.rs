//! The robot as the flange feels: ideal, or soft about its servos.

use crate::input::{Check, InputError, read};
use crate::units::N_PER_MM;
use serde::Deserialize;

/// A checked robot, SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Name, as used on the command line.
    pub name: String,
    /// One line for lists.
    pub description: String,
    /// How the flange follows its command.
    pub flange: Flange,
    /// Plug-socket contact force at which the robot stops moving, N.
    pub stop_force: f64,
}

/// How a flange follows its command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Flange {
    /// Exactly.
    Ideal,
    /// Through a spring and damper per Cartesian axis at the TCP.
    Servo(Servo),
}

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
    /// 1 is critical.
    pub damping_ratio: f64,
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
}

impl Robot {
    /// Reads and checks a robot; `file` is named in errors.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let raw: RawRobot = read(text, file)?;
        let check = Check { file };
        let positive = |key: &str, value: f64| check.positive(key, value);
        match raw {
            RawRobot::Rigid { name, description, stop_force_n } => Ok(Robot {
                name,
                description,
                flange: Flange::Ideal,
                stop_force: positive("stop_force_n", stop_force_n)?,
            }),
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
                for k in stiffness_n_per_mm {
                    positive("stiffness_n_per_mm", k)?;
                }
                for k in rotational_stiffness_nm_per_rad {
                    positive("rotational_stiffness_nm_per_rad", k)?;
                }
                let servo = Servo {
                    stiffness: stiffness_n_per_mm.map(|k| k * N_PER_MM),
                    rotational_stiffness: rotational_stiffness_nm_per_rad,
                    mass: positive("mass_kg", mass_kg)?,
                    inertia: positive("inertia_kg_m2", inertia_kg_m2)?,
                    damping_ratio: positive("damping_ratio", damping_ratio)?,
                };
                Ok(Robot {
                    name,
                    description,
                    flange: Flange::Servo(servo),
                    stop_force: positive("stop_force_n", stop_force_n)?,
                })
            }
        }
    }
}
