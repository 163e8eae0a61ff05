//! Robot with the stiffness identified from the logs.

use super::formulas::Flange;
use ask_tell::statistics::weighted_mean;
use input::units::N_PER_MM;
use insertion::Robot;
use insertion::robot::{Drive, Servo};

/// Prior relative standard deviation of the stiffness of an axis, about that of the robot file times a common factor.
const AXIS_SD: f64 = 0.2;
/// Servo for a robot file without one, if all axes are identified; masses, damping and rotational stiffness are those
/// of `robots/servo.toml`.
const SOFT: Servo = Servo {
    stiffness: [10.0 * N_PER_MM; 3],
    rotational_stiffness: [400.0; 3],
    mass: 2.0,
    inertia: 0.01,
    damping_ratio: 1.0,
};

/// Returns the robot with the identified stiffness, and the smallest relative standard deviation of an axis; the robot
/// as it is if too few axes are identified. The stiffness of each axis is that of the robot file times a factor;
/// uncertain factors are shrunk towards the common factor, which also applies to the rotations.
pub fn identified_robot(own: &Robot, flange: &[Option<Flange>; 3]) -> (Robot, Option<f64>) {
    let identified = flange.iter().flatten().count();
    let base = match own.drive {
        Drive::Servo(servo) if identified > 0 => servo,
        _ if identified == 3 => SOFT,
        _ => return (own.clone(), None),
    };
    let axis = |i: usize| {
        let stiffness = flange[i].as_ref()?.stiffness;
        Some((libm::log(stiffness.mean / base.stiffness[i]), stiffness.sd / stiffness.mean))
    };
    let axes = [0, 1, 2].map(axis);
    let weight = |sd: f64| 1.0 / (sd * sd + AXIS_SD * AXIS_SD);
    let common = weighted_mean(axes.iter().flatten().map(|(log, sd)| (*log, weight(*sd))));
    let each = axes.map(|axis| match axis {
        None => common,
        Some((log, sd)) => {
            weighted_mean([(log, 1.0 / (sd * sd)), (common, 1.0 / (AXIS_SD * AXIS_SD))])
        }
    });
    let sd = axes.iter().flatten().map(|(_, sd)| *sd).fold(f64::INFINITY, f64::min);
    let mut servo = base;
    servo.stiffness.iter_mut().zip(each).for_each(|(k, log)| *k *= libm::exp(log));
    servo.rotational_stiffness = base.rotational_stiffness.map(|k| k * libm::exp(common));
    (Robot { name: "identified".to_owned(), drive: Drive::Servo(servo), ..own.clone() }, Some(sd))
}
