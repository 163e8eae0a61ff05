//! A robot with the stiffness that the logs tell.

use super::formulas::Flange;
use input::units::N_PER_MM;
use insertion::robot::{Drive, Robot, Servo};

/// How much the axes of a flange differ from the robot file's proportions, as a share.
const ALIKE: f64 = 0.2;
/// A flange that all axes are told of: what is left is a wrist and a gripper, as of `robots/servo.toml`.
const SOFT: Servo = Servo {
    stiffness: [10.0 * N_PER_MM; 3],
    rotational_stiffness: [400.0; 3],
    mass: 2.0,
    inertia: 0.01,
    damping_ratio: 1.0,
};

/// The robot with what the logs tell of its axes: each is the robot file's times a factor, and the
/// factors of axes that are told badly follow the others. Rotations follow all of them.
pub fn told(own: &Robot, flange: &[Option<Flange>; 3]) -> (Robot, Option<f64>) {
    let told = flange.iter().flatten().count();
    let base = match own.drive {
        Drive::Servo(servo) => servo,
        _ if told == 3 => SOFT,
        _ => return (own.clone(), None),
    };
    let axis = |i: usize| {
        let stiffness = flange[i].as_ref()?.stiffness;
        Some((libm::log(stiffness.mean / base.stiffness[i]), stiffness.sd / stiffness.mean))
    };
    let axes = [0, 1, 2].map(axis);
    let weight = |sd: f64| 1.0 / (sd * sd + ALIKE * ALIKE);
    let sums = axes
        .iter()
        .flatten()
        .fold((0.0, 0.0), |(sum, all), (log, sd)| (sum + weight(*sd) * log, all + weight(*sd)));
    if told == 0 {
        return (own.clone(), None);
    }
    let common = sums.0 / sums.1;
    let each = axes.map(|axis| match axis {
        None => common,
        Some((log, sd)) => {
            let (own, others) = (1.0 / (sd * sd), 1.0 / (ALIKE * ALIKE));
            (own * log + others * common) / (own + others)
        }
    });
    let sd = axes.iter().flatten().map(|(_, sd)| *sd).fold(f64::INFINITY, f64::min);
    let mut servo = base;
    for (stiffness, log) in servo.stiffness.iter_mut().zip(each) {
        *stiffness *= libm::exp(log);
    }
    servo.rotational_stiffness = base.rotational_stiffness.map(|k| k * libm::exp(common));
    let name = "identified".to_owned();
    (Robot { name, drive: Drive::Servo(servo), ..own.clone() }, Some(sd))
}
