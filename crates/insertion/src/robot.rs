//! Robot, modelled at its flange: rigid, on servo springs, or an arm with joint servos.

use crate::arm::{Arm, ArmError, RawArm, ReducedArm};
use input::units::read::n_per_mm;
use input::{Check, Document, InputError, wrong_unit};
use nalgebra::Vector3;
use parameters::numbers;
use serde::Deserialize;

/// A checked robot, SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Name on the command line.
    pub name: String,
    /// One-line description for lists.
    pub description: String,
    /// Model of the flange, independent of the pose.
    pub drive: Drive,
    /// Plug-socket contact force at which the robot stops moving, N.
    pub stop_force: f64,
}

/// Largest acceptable contact force as a share of a robot's stop force: an assumption, since the scatter of peak forces
/// on robots is unknown.
pub const STOP_SHARE: f64 = 0.9;

/// Dynamic model of a robot's flange.
#[derive(Debug, Clone, PartialEq)]
pub enum FlangeModel<A> {
    /// Rigid: the flange follows its command exactly.
    Ideal,
    /// A spring and damper per Cartesian axis at the TCP.
    Servo(Servo),
    /// Six joints with servos.
    Arm(Box<A>),
}

/// Flange model of a robot file, independent of the pose.
pub type Drive = FlangeModel<Arm>;

/// Flange model at the start of a task; an arm is reduced to coupled springs, dampers and mass at the TCP.
pub type Flange = FlangeModel<ReducedArm>;

/// A servo-compliant flange, SI units, axes of the task frame.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Servo {
    /// Stiffness along x, y and z, N/m.
    #[serde(rename = "stiffness_n_per_mm", deserialize_with = "n_per_mm")]
    pub stiffness: [f64; 3],
    /// Stiffness about x, y and z, N m/rad.
    #[serde(rename = "rotational_stiffness_nm_per_rad")]
    pub rotational_stiffness: [f64; 3],
    /// Effective mass at the TCP, kg.
    #[serde(rename = "mass_kg")]
    pub mass: f64,
    /// Effective moment of inertia about each axis, kg m2.
    #[serde(rename = "inertia_kg_m2")]
    pub inertia: f64,
    /// Damping ratio; 1 is critical.
    pub damping_ratio: f64,
}

/// A robot at the start of a task.
#[derive(Debug, Clone, PartialEq)]
pub struct MountedRobot {
    /// Response of the flange to its command.
    pub flange: Flange,
    stop_force: f64,
}

impl Robot {
    /// Reads and checks a robot; `file` is named in errors.
    ///
    /// # Errors
    /// If the text is not a robot file, or a value is out of range.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let document = Document::parse(text, file)?;
        let OfKind { kind } = document.read()?;
        numbers::check_file("robot", &document.read()?, file)?;
        // Read before the header, one of whose keys may be misspelt.
        let (own, check) = (document.clone().without(&HEADER), Check { file });
        let drive = match kind {
            Kind::Rigid => own.read().map(|Rigid {}| Drive::Ideal)?,
            Kind::Servo => Drive::Servo(own.read()?),
            Kind::Arm => Drive::Arm(Box::new(own.read::<RawArm>()?.arm(check)?)),
        };
        let Header { name, description, stop_force } = document.read()?;
        if let Drive::Servo(Servo { mass, .. }) = drive {
            check.unit("mass_kg", wrong_unit::number("mass_kg", mass, MASS_KG))?;
        }
        Ok(Robot { name, description, drive, stop_force })
    }

    /// Returns a remark on the contact forces of a rigid robot; `None` for a compliant one.
    pub fn remark(&self) -> Option<String> {
        let Robot { name, stop_force, .. } = self;
        matches!(self.drive, Drive::Ideal).then(|| {
            format!(
                "the robot `{name}` does not yield: a real one has lower contact forces; it stops above {stop_force} N"
            )
        })
    }

    /// Returns the robot without stop force and torque limits of its joints.
    pub fn without_stops(mut self) -> Self {
        self.stop_force = f64::INFINITY;
        if let Drive::Arm(arm) = &mut self.drive {
            arm.joints.iter_mut().for_each(|joint| joint.limit = f64::INFINITY);
        }
        self
    }

    /// Returns the largest acceptable contact force, N: the smaller of the connector's limit, if it has one, and the
    /// acceptable share of the stop force.
    pub fn acceptable_force(&self, connector: Option<f64>) -> f64 {
        connector.unwrap_or(f64::INFINITY).min(STOP_SHARE * self.stop_force)
    }

    /// Returns the robot at the start of a task whose frame is turned by `turn` about the
    /// base's z, with the TCP tilted by `tilt` about the task's x, rad.
    ///
    /// # Errors
    /// If an arm does not reach the start, or is singular there.
    pub fn mount(&self, turn: f64, tilt: f64) -> Result<MountedRobot, ArmError> {
        let flange = match &self.drive {
            Drive::Ideal => Flange::Ideal,
            Drive::Servo(servo) => Flange::Servo(*servo),
            Drive::Arm(arm) => Flange::Arm(Box::new(arm.at_start(turn, tilt)?)),
        };
        Ok(MountedRobot { flange, stop_force: self.stop_force })
    }
}

/// Range of the effective mass of wrist and gripper at the TCP, kg.
const MASS_KG: [f64; 2] = [0.05, 100.0];

/// Settling time of a servo, in time constants.
const SETTLING_TIME_CONSTANTS: f64 = 5.0;

impl MountedRobot {
    /// Returns the overtravel of an assembly move along a unit vector, m: the deflection of the arm under its
    /// assembly force, without which a soft arm would hardly push the part; 0 unless the robot is an arm.
    pub fn overtravel(&self, along: &Vector3<f64>) -> f64 {
        let deflection =
            |arm: &ReducedArm| arm.assembly_force * along.dot(&(arm.compliance * along));
        self.arm().map_or(0.0, deflection)
    }

    /// Returns the settling time of the servos after a command, s; 0 unless the robot is an arm.
    pub fn settling_time(&self) -> f64 {
        self.arm().map_or(0.0, |arm| SETTLING_TIME_CONSTANTS * arm.time_constant)
    }

    /// Returns whether a plug-socket force, N, task axes, stops the robot or overloads a joint.
    pub fn stops(&self, force: &Vector3<f64>) -> bool {
        self.arm().is_some_and(|arm| arm.overloaded(force)) || force.norm() > self.stop_force
    }

    fn arm(&self) -> Option<&ReducedArm> {
        if let Flange::Arm(arm) = &self.flange { Some(arm) } else { None }
    }
}

/// Kinds of a robot file.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Kind {
    Rigid,
    Servo,
    Arm,
}

/// Kind of a robot file, which determines its keys beside those of [`Header`]. Not a tagged enum, whose errors have no
/// line number.
#[derive(Deserialize)]
struct OfKind {
    kind: Kind,
}

/// Keys common to all robot files beside [`OfKind`].
#[derive(Deserialize)]
struct Header {
    name: String,
    description: String,
    #[serde(rename = "stop_force_n")]
    stop_force: f64,
}

/// Keys of [`OfKind`] and [`Header`].
const HEADER: [&str; 4] = ["kind", "name", "description", "stop_force_n"];

/// Keys of a rigid robot beside those of [`Header`].
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rigid {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::{refused, robot_file};
    use input::shipped::ROBOTS;
    use input::{Place, Placed};

    #[test]
    fn implausible_numbers_are_refused() {
        let servo = robot_file("servo");
        let line = |key: &str| servo.text.lines().find(|line| line.starts_with(key)).unwrap();
        for (key, value, problem) in [
            ("mass_kg", "1e9", "must lie in 0.001 .. 1000"),
            ("mass_kg", "2000", "is 2000; it must lie in 0.001 .. 1000"),
            ("mass_kg", "nan", "must lie in"),
            ("stiffness_n_per_mm", "[10000.0, 10000.0, 20000.0]", "must lie in 0.01 .. 5000"),
            ("stiffness_n_per_mm", "[10.0, 10.0, 1e-9]", "must lie in 0.01 .. 5000"),
            ("rotational_stiffness_nm_per_rad", "[0, 400, 400]", "must lie in 0.01 .."),
            ("stop_force_n", "1e-9", "must lie in 0.1 .. 100000"),
        ] {
            let text = servo.text.replace(line(key), &format!("{key} = {value}"));
            let error = Robot::parse(&text, "r.toml").unwrap_err().to_string();
            assert!(error.starts_with(&format!("r.toml: {key}: ")), "{error}");
            assert!(error.contains(problem), "{key} = {value}: {error}");
        }
        let heavy = servo.text.replace(line("mass_kg"), "mass_kg = 900");
        refused(
            Robot::parse(&heavy, "r.toml"),
            &["mass_kg: 900 kg is outside", "in g, multiply by 0.001: 0.90 kg"],
        );
        let arm = robot_file("ur5e");
        let short = arm.text.replace(".0, ", "e-3, ").replace(".0]", "e-3]");
        refused(Robot::parse(&short, "r.toml"), &["joint: all offset_mm together: 1."]);
        let home = arm.text.replace("home_deg = [270.0, -90.0,", "home_deg = [1.57, -90.0,");
        Robot::parse(&home, "r.toml").unwrap();
        let home = arm.text.lines().map(|line| match line.starts_with("home_deg") {
            true => "home_deg = [4.7, -1.6, -1.6, 4.7, 1.6, 0]",
            false => line,
        });
        let home = home.collect::<Vec<_>>().join("\n");
        refused(Robot::parse(&home, "r.toml"), &["home_deg: 4.7 degrees: are", "269.3 degrees"]);
        let flat = arm.text.replace(
            "home_deg = [270.0, -90.0, -90.0, 270.0, 90.0, 0.0]",
            "home_deg = [0.5, 0, 0, -1.5, 0, 0]",
        );
        assert_ne!(flat, arm.text);
        Robot::parse(&flat, "r.toml").unwrap();
        // Its tool would point down in radians, but 280 degrees are none.
        let far = flat.replace("[0.5, 0, 0, -1.5, 0, 0]", "[280, 303, 208, 34, -84, 0.5]");
        Robot::parse(&far, "r.toml").unwrap();
        let (five, _) = short.rsplit_once("[[joint]]").unwrap();
        refused(Robot::parse(five, "r.toml"), &["there are 5 [[joint]]"]);
        let heavy = robot_file("ur5e").text.replace("link_mass_kg = 3.7", "link_mass_kg = 3700");
        let problem = "joint \"shoulder pan\" link_mass_kg: is 3700";
        refused(Robot::parse(&heavy, "r.toml"), &[problem]);
    }

    #[test]
    fn a_value_of_a_wrong_type_is_reported_with_its_line() {
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
